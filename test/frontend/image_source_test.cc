#include "frontend/image_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "common/support/input_error.h"
#include "test/frontend/synthetic_scene.h"

namespace duet {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ImageSourceTest : public testing::Test {
 protected:
  ImageSourceTest()
      : folder_(fs::temp_directory_path() /
                ("duet_image_source_" + std::to_string(getpid()) + "_" +
                 testing::UnitTest::GetInstance()->current_test_info()->name())) {
    fs::create_directories(folder_);
    for (int i = 0; i < 40; ++i) {
      ImageFiles files{.timestamp = 1000 + i, .paths = {}};
      for (int camera = 0; camera < 2; ++camera) {
        const std::string path =
            (folder_ / (std::to_string(camera) + "_" + std::to_string(i) + ".png")).string();
        cv::imwrite(path, cv::Mat(240, 376, CV_8U, cv::Scalar(i + 100 * camera)));
        files.paths.push_back(path);
      }
      files_.push_back(files);
    }
  }
  ~ImageSourceTest() override { fs::remove_all(folder_); }

  void Damage(std::size_t stamp, std::size_t camera) const {
    std::ofstream(files_[stamp].paths[camera], std::ios::trunc) << "no image";
  }

  std::string ErrorOf() {
    ImageSource source(files_, rig_);
    try {
      while (source.Next()) {
      }
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
  RigCalibration rig_ = SmallRig(true);
  std::vector<ImageFiles> files_;
};

TEST_F(ImageSourceTest, GivesEveryImageInOrderForAnyQueue) {
  for (const int queue_length : {1, 3, 100}) {
    ImageSource source(files_, rig_, queue_length);
    for (int i = 0; i < 40; ++i) {
      const std::optional<ImageSet> set = source.Next();
      ASSERT_TRUE(set);
      EXPECT_EQ(set->timestamp, 1000 + i);
      ASSERT_EQ(set->images.size(), 2U);
      EXPECT_EQ(set->images[0].at<unsigned char>(17, 5), i);
      EXPECT_EQ(set->images[1].at<unsigned char>(17, 5), i + 100);
    }
    EXPECT_FALSE(source.Next());
    EXPECT_FALSE(source.Next());
    EXPECT_TRUE(source.dropped().empty());
  }
}

TEST_F(ImageSourceTest, DropsAndCountsWhatCannotBeRead) {
  Damage(7, 0);
  fs::remove(files_[9].paths[1]);
  ImageSource source(files_, rig_);
  std::vector<Timestamp> stamps;
  while (const std::optional<ImageSet> set = source.Next()) {
    stamps.push_back(set->timestamp);
    EXPECT_EQ(set->images[1].empty(), set->timestamp == 1009);
  }
  EXPECT_EQ(stamps.size(), 39U);
  EXPECT_EQ(std::count(stamps.begin(), stamps.end(), 1007), 0);
  ASSERT_EQ(source.dropped().size(), 2U);
  EXPECT_EQ(source.dropped()[0].timestamp, 1007);
  EXPECT_EQ(source.dropped()[0].camera, 0);
  EXPECT_EQ(source.dropped()[1].camera, 1);
  EXPECT_EQ(source.dropped()[1].path, files_[9].paths[1]);
}

TEST_F(ImageSourceTest, TheFirstImageMustBeReadable) {
  Damage(0, 1);
  EXPECT_THAT(ErrorOf(), HasSubstr(files_[0].paths[1] + ": "));
  EXPECT_THAT(ErrorOf(), HasSubstr("first image"));
}

TEST_F(ImageSourceTest, MoreThanOneInTwentyMissingIsBadInput) {
  for (const std::size_t stamp : {5U, 20U}) Damage(stamp, 0);
  EXPECT_EQ(ErrorOf(), "");  // two in forty
  Damage(30, 0);
  EXPECT_THAT(ErrorOf(), HasSubstr("more than one image in twenty"));
}

TEST_F(ImageSourceTest, AnotherSizeThanTheCalibrationsIsBadInput) {
  cv::imwrite(files_[12].paths[0], cv::Mat(120, 188, CV_8U, cv::Scalar(1)));
  EXPECT_THAT(ErrorOf(), HasSubstr(files_[12].paths[0]));
  EXPECT_THAT(ErrorOf(), HasSubstr("188 x 120"));
  EXPECT_THAT(ErrorOf(), HasSubstr("376 x 240"));
}

TEST_F(ImageSourceTest, MayBeLeftHalfRead) {
  ImageSource source(files_, rig_, 2);
  (void)source.Next();
}

TEST_F(ImageSourceTest, NoFilesNoImages) {
  ImageSource source({}, rig_);
  EXPECT_FALSE(source.Next());
}

}  // namespace
}  // namespace duet
