#include "experiments/simulation/render/image_writer.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/imgcodecs.hpp>
#include <string>

#include "common/support/input_error.h"
#include "common/support/random.h"

namespace duet {
namespace {

namespace fs = std::filesystem;

class ImageWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("image_writer_" +
               std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  static cv::Mat Noise(std::uint64_t seed) {
    Random random(seed);
    cv::Mat image(40, 60, CV_8UC1);
    for (int v = 0; v < image.rows; ++v) {
      for (int u = 0; u < image.cols; ++u) {
        image.at<std::uint8_t>(v, u) = static_cast<std::uint8_t>(random.UniformInt(256));
      }
    }
    return image;
  }
  static std::string Bytes(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  fs::path folder_;
};

TEST_F(ImageWriterTest, FilesHoldTheImagesWhateverTheThreads) {
  for (const int threads : {1, 3}) {
    ImageWriter writer(threads);
    for (std::uint64_t i = 0; i < 20; ++i) {
      writer.Write(Noise(i),
                   folder_ / (std::to_string(threads) + "_" + std::to_string(i) + ".png"));
    }
    writer.Finish();
  }
  for (std::uint64_t i = 0; i < 20; ++i) {
    const fs::path one = folder_ / ("1_" + std::to_string(i) + ".png");
    const fs::path three = folder_ / ("3_" + std::to_string(i) + ".png");
    EXPECT_EQ(Bytes(one), Bytes(three));
    const cv::Mat read = cv::imread(three.string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(read.type(), CV_8UC1);
    EXPECT_EQ(cv::norm(read, Noise(i), cv::NORM_INF), 0.0);
  }
}

TEST_F(ImageWriterTest, AFullDiskIsAnOutputError) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  ImageWriter writer(2);
  writer.Write(Noise(1), "/dev/full");
  EXPECT_THROW(writer.Finish(), OutputError);
}

TEST_F(ImageWriterTest, AnErrorStopsTheCallerSoonAndNamesTheFile) {
  ImageWriter writer(2);
  const fs::path missing = folder_ / "missing" / "1.png";
  try {
    for (int i = 0; i < 1000; ++i) writer.Write(Noise(1), missing);
    FAIL() << "a thousand images went nowhere";
  } catch (const OutputError& error) {
    EXPECT_NE(std::string(error.what()).find(missing.string()), std::string::npos);
  }
  EXPECT_THROW(writer.Finish(), OutputError);
}

TEST_F(ImageWriterTest, CanBeLeftWithoutFinishing) {
  ImageWriter writer(2);
  for (int i = 0; i < 4; ++i) writer.Write(Noise(1), folder_ / (std::to_string(i) + ".png"));
}

}  // namespace
}  // namespace duet
