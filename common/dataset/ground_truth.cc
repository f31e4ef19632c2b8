#include "common/dataset/ground_truth.h"

#include <algorithm>

#include "common/dataset/csv_reader.h"
#include "common/support/numeric_text.h"
#include "common/support/text_file.h"

namespace duet {
namespace {

const std::vector<std::string> kPoseColumns = {"timestamp [ns]", "p_RS_R_x [m]", "p_RS_R_y [m]",
                                               "p_RS_R_z [m]",   "q_RS_w []",    "q_RS_x []",
                                               "q_RS_y []",      "q_RS_z []"};
const std::vector<std::string> kStateColumns = {"timestamp [ns]",
                                                "p_RS_R_x [m]",
                                                "p_RS_R_y [m]",
                                                "p_RS_R_z [m]",
                                                "q_RS_w []",
                                                "q_RS_x []",
                                                "q_RS_y []",
                                                "q_RS_z []",
                                                "v_RS_R_x [m s^-1]",
                                                "v_RS_R_y [m s^-1]",
                                                "v_RS_R_z [m s^-1]",
                                                "b_w_RS_S_x [rad s^-1]",
                                                "b_w_RS_S_y [rad s^-1]",
                                                "b_w_RS_S_z [rad s^-1]",
                                                "b_a_RS_S_x [m s^-2]",
                                                "b_a_RS_S_y [m s^-2]",
                                                "b_a_RS_S_z [m s^-2]"};

void AppendVector(const Eigen::Vector3d& vector, char separator, std::string* text) {
  for (int axis = 0; axis < 3; ++axis) {
    text->push_back(separator);
    AppendNumber(vector[axis], text);
  }
}

}  // namespace

GroundTruth ReadGroundTruthTable(std::string_view csv, const std::string& file) {
  CsvReader reader(csv, file, {kStateColumns, kPoseColumns});
  GroundTruth truth;
  bool velocities_known = false;
  bool biases_known = false;
  while (reader.Next()) {
    StampedPose& pose = truth.poses.emplace_back();
    pose.timestamp = reader.CheckLater(0, reader.Stamp(0));
    pose.T_GB.p = ReadVector(reader, 1);
    pose.T_GB.R = ReadQuaternion(reader, 4, /*w_first=*/true);
    if (reader.column_count() == static_cast<int>(kPoseColumns.size())) continue;
    truth.velocities.push_back(ReadVector(reader, 8));
    truth.biases.push_back({ReadVector(reader, 11), ReadVector(reader, 14)});
    velocities_known |= !truth.velocities.back().isZero(0.0);
    biases_known |= !truth.biases.back().b_g.isZero(0.0) || !truth.biases.back().b_a.isZero(0.0);
  }
  reader.RequireRows();
  if (!velocities_known) truth.velocities.clear();
  if (!biases_known) truth.biases.clear();
  return truth;
}

GroundTruth ReadTumTrajectory(std::string_view text, const std::string& file) {
  CsvReader reader(text, file, {{"t [s]", "x [m]", "y [m]", "z [m]", "qx", "qy", "qz", "qw"}}, ' ');
  GroundTruth truth;
  while (reader.Next()) {
    StampedPose& pose = truth.poses.emplace_back();
    pose.timestamp = reader.CheckLater(0, reader.StampInSeconds(0));
    pose.T_GB.p = ReadVector(reader, 1);
    pose.T_GB.R = ReadQuaternion(reader, 4, /*w_first=*/false);
  }
  reader.RequireRows();
  return truth;
}

GroundTruth ReadTrajectory(std::string_view text, const std::string& file) {
  // The first line that is no comment decides.
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    const std::string_view row = rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (row.empty() || row.front() == '#' || row == "\r") continue;
    if (row.find(',') != std::string_view::npos) return ReadGroundTruthTable(text, file);
    break;
  }
  return ReadTumTrajectory(text, file);
}

GroundTruth ReadTrajectoryFile(const std::filesystem::path& path) {
  return ReadTrajectory(ReadTextFile(path), path.string());
}

std::string WriteGroundTruthTable(const GroundTruth& truth) {
  std::string text = "#";
  for (const std::string& column : kStateColumns) {
    if (text.size() > 1) text.push_back(',');
    text += column;
  }
  text.push_back('\n');
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    const StampedPose& pose = truth.poses[i];
    const Eigen::Quaterniond& R = pose.T_GB.R;
    AppendNumber(pose.timestamp, &text);
    AppendVector(pose.T_GB.p, ',', &text);
    for (const double number : {R.w(), R.x(), R.y(), R.z()}) {
      text.push_back(',');
      AppendNumber(number, &text);
    }
    AppendVector(truth.has_velocities() ? truth.velocities.at(i) : Eigen::Vector3d::Zero(), ',',
                 &text);
    const ImuBiases biases = truth.has_biases() ? truth.biases.at(i) : ImuBiases();
    AppendVector(biases.b_g, ',', &text);
    AppendVector(biases.b_a, ',', &text);
    text.push_back('\n');
  }
  return text;
}

std::string WriteTumTrajectory(const std::vector<StampedPose>& poses) {
  std::string text = "# t [s] x y z [m] qx qy qz qw of R_GB\n";
  for (const StampedPose& pose : poses) {
    const Eigen::Quaterniond& R = pose.T_GB.R;
    AppendSeconds(pose.timestamp, &text);
    AppendVector(pose.T_GB.p, ' ', &text);
    for (const double number : {R.x(), R.y(), R.z(), R.w()}) {
      text.push_back(' ');
      AppendNumber(number, &text);
    }
    text.push_back('\n');
  }
  return text;
}

GroundTruth GroundTruthOf(const std::vector<InertialState>& states) {
  GroundTruth truth;
  for (const InertialState& state : states) {
    truth.poses.push_back({state.instant, state.nav.pose()});
    truth.velocities.push_back(state.nav.v_GB);
    truth.biases.push_back(state.biases);
  }
  return truth;
}

}  // namespace duet
