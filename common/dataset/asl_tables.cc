#include "common/dataset/asl_tables.h"

#include "common/dataset/csv_reader.h"
#include "common/support/numeric_text.h"

namespace duet {

std::vector<ImuSample> ReadImuTable(std::string_view csv, const std::string& file) {
  CsvReader reader(
      csv, file,
      {{"timestamp [ns]", "w_RS_S_x [rad s^-1]", "w_RS_S_y [rad s^-1]", "w_RS_S_z [rad s^-1]",
        "a_RS_S_x [m s^-2]", "a_RS_S_y [m s^-2]", "a_RS_S_z [m s^-2]"}});
  std::vector<ImuSample> samples;
  while (reader.Next()) {
    ImuSample& sample = samples.emplace_back();
    sample.timestamp = reader.CheckLater(0, reader.Stamp(0));
    for (int axis = 0; axis < 3; ++axis) {
      sample.omega_m[axis] = reader.Number(1 + axis);
      sample.a_m[axis] = reader.Number(4 + axis);
    }
  }
  reader.RequireRows();
  return samples;
}

std::string WriteImuTable(const std::vector<ImuSample>& samples) {
  std::string text =
      "#timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],"
      "a_RS_S_x [m s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]\n";
  for (const ImuSample& sample : samples) {
    AppendNumber(sample.timestamp, &text);
    for (const Eigen::Vector3d* vector : {&sample.omega_m, &sample.a_m}) {
      for (int axis = 0; axis < 3; ++axis) {
        text.push_back(',');
        AppendNumber((*vector)[axis], &text);
      }
    }
    text.push_back('\n');
  }
  return text;
}

std::vector<ImageName> ReadImageTable(std::string_view csv, const std::string& file) {
  CsvReader reader(csv, file, {{"timestamp [ns]", "filename"}});
  std::vector<ImageName> images;
  while (reader.Next()) {
    ImageName& image = images.emplace_back();
    image.timestamp = reader.CheckLater(0, reader.Stamp(0));
    image.name = std::string(reader.Text(1));
    if (image.name.empty() || image.name == "." || image.name == ".." ||
        image.name.find_first_of("/\\") != std::string::npos) {
      reader.Fail(1, "expected the name of a file in data/, got '" + image.name + "'");
    }
  }
  reader.RequireRows();
  return images;
}

}  // namespace duet
