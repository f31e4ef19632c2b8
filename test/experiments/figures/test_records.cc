#include "test/experiments/figures/test_records.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <sstream>

#include "common/support/numeric_text.h"
#include "common/support/text_file.h"

namespace duet {
namespace fs = std::filesystem;
namespace {

constexpr long long kFirst = 1'000'000'000;
constexpr long long kStep = 50'000'000;

std::vector<std::string> FieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream in(line);
  for (std::string field; std::getline(in, field, ',');) fields.push_back(field);
  return fields;
}

}  // namespace

FiguresFolder::FiguresFolder() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  path_ = fs::temp_directory_path() /
          ("duet_figures_" + std::string(test->name()) + "_" + std::to_string(getpid()));
  fs::remove_all(path_);
  fs::create_directories(path_);
}

FiguresFolder::~FiguresFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void WriteTestRecord(const TestRecord& record, const fs::path& folder) {
  fs::create_directories(folder);
  WriteTextFile(folder / "manifest.json",
                "{\"version\": \"1\", \"commit\": \"c\", \"backend\": \"" + record.estimator +
                    "\", \"init\": \"" + record.init +
                    "\", \"command_line\": \"duet run --backend " + record.estimator +
                    "\", \"tracks_sha256\": \"abcdef\", \"dataset\": {\"path\": \"absent/mav0\", "
                    "\"cameras\": [0], \"first_frame_ns\": " +
                    std::to_string(kFirst) + "}, \"outcome\": {\"status\": \"done\"}}\n");
  if (record.seed >= 0) {
    WriteTextFile(folder / "study.json",
                  "{\"stream\": \"" + record.stream + "\", \"estimator\": \"" + record.estimator +
                      "\", \"setting\": \"" + record.setting + "\", \"perturbation\": \"" +
                      record.perturbation + "\", \"seed\": " + std::to_string(record.seed) + "}\n");
  }
  std::string states =
      "#timestamp [ns],frame [ns],status,q_GB_x [],q_GB_y [],q_GB_z [],q_GB_w [],p_GB_x [m],"
      "p_GB_y [m],p_GB_z [m],v_GB_x [m s^-1],v_GB_y [m s^-1],v_GB_z [m s^-1],b_g_x [rad s^-1],"
      "b_g_y [rad s^-1],b_g_z [rad s^-1],b_a_x [m s^-2],b_a_y [m s^-2],b_a_z [m s^-2],t_d [s],"
      "sigma_t_d [s]\n";
  std::string truth =
      "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z,v_x,v_y,v_z,bg_x,bg_y,bg_z,ba_x,ba_y,ba_z\n";
  std::string covariance =
      "#timestamp [ns],size,lower triangle by rows, order theta p v b_g b_a calibration\n";
  std::string timing = "#timestamp [ns],estimator [ms],estimator.update [ms],estimator.rest [ms]\n";
  for (int i = 0; i < record.states; ++i) {
    const std::string stamp = std::to_string(kFirst + i * kStep);
    const double angle = 0.1 * i;
    const std::string y = FormatNumber(std::sin(angle));
    states += stamp + "," + stamp + ",tracking,0,0,0,1," + FormatNumber(std::cos(angle)) + "," + y +
              ",0,0,0,0,0,0,0,0,0,0,0.001," + FormatNumber(0.01 / (1 + i)) + "\n";
    truth += stamp + "," + FormatNumber(std::cos(angle) + record.error_m) + "," + y +
             ",0,1,0,0,0,1,0,0,0,0,0,0,0,1\n";
    covariance += stamp + ",15";
    for (int row = 0; row < 15; ++row) {
      for (int k = 0; k < row; ++k) covariance += ",0";
      covariance += row < 3 ? ",0.0001" : row < 6 ? ",0.01" : ",1";
    }
    covariance += '\n';
    timing += stamp + "," + FormatNumber(1.0 + 0.1 * i) + ",1," + FormatNumber(0.1 * i) + "\n";
  }
  WriteTextFile(folder / "states.csv", states);
  WriteTextFile(folder / "truth.csv", truth);
  WriteTextFile(folder / "timing.csv", timing);
  if (record.covariance) WriteTextFile(folder / "covariance.csv", covariance);
}

FigureTable ReadFigureTable(const fs::path& file) {
  FigureTable table;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("# ", 0) == 0) {
      table.comments.push_back(line.substr(2));
    } else if (line[0] == '#') {
      table.heads = FieldsOf(line.substr(1));
    } else {
      table.rows.push_back(FieldsOf(line));
    }
  }
  return table;
}

std::vector<double> FigureTable::Column(const std::string& head) const {
  std::vector<double> numbers;
  int found = -1;
  for (std::size_t k = 0; k < heads.size(); ++k) {
    if (heads[k].rfind(head, 0) != 0) continue;
    EXPECT_EQ(found, -1) << head << " is not one column alone";
    found = static_cast<int>(k);
  }
  EXPECT_NE(found, -1) << "no column " << head;
  if (found < 0) return numbers;
  for (const std::vector<std::string>& row : rows) {
    numbers.push_back(std::stod(row.at(static_cast<std::size_t>(found))));
  }
  while (!numbers.empty() && std::isnan(numbers.back())) numbers.pop_back();
  return numbers;
}

}  // namespace duet
