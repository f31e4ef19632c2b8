#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace duet {

/// A folder that goes with the object.
class FiguresFolder {
 public:
  FiguresFolder();
  ~FiguresFolder();
  FiguresFolder(const FiguresFolder&) = delete;
  FiguresFolder& operator=(const FiguresFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path operator/(const std::string& name) const {
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

/// A run record whose numbers are known in closed form: `states` states at 20 Hz along a circle of
/// 1 m, the truth `error_m` further along x, every standard deviation of the position 0.1 m and of
/// the orientation 0.01 rad, no error of the orientation.
struct TestRecord {
  std::string estimator = "msckf";
  int states = 40;
  double error_m = 0.1;
  bool covariance = true;
  std::string init = "groundtruth";
  /// Of a study: written into study.json; seed -1: a plain record.
  std::string stream = "room", setting = "default", perturbation = "none";
  int seed = -1;
};
void WriteTestRecord(const TestRecord& record, const std::filesystem::path& folder);

/// A comma-separated table: fields by rows, comments and heads left out; the heads apart.
struct FigureTable {
  std::vector<std::string> comments;
  std::vector<std::string> heads;
  std::vector<std::vector<std::string>> rows;

  /// The numbers of a column until its first "nan" that nothing follows; heads are matched by their
  /// begin, and one alone must match.
  [[nodiscard]] std::vector<double> Column(const std::string& head) const;
};
[[nodiscard]] FigureTable ReadFigureTable(const std::filesystem::path& file);

}  // namespace duet
