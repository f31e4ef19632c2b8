#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/dataset/asl_tables.h"
#include "common/dataset/csv_reader.h"
#include "common/dataset/ground_truth.h"
#include "common/support/input_error.h"
#include "common/support/random.h"

namespace duet {
namespace {

using testing::HasSubstr;
using testing::StrEq;
using testing::ThrowsMessage;

const std::string kImuHeader = "#timestamp [ns],wx,wy,wz,ax,ay,az\n";
const std::string kImuRow = "100,1,2,3,4,5,6\n";

TEST(ImuTable, ReadsLfCrlfBlanksAndHeaders) {
  for (const std::string& text :
       {kImuHeader + kImuRow + "105,-1.5,2e-1,3,4,5,6\n",
        std::string("#t,a\r\n100,1,2,3,4,5,6\r\n105,-1.5,2e-1,3,4,5,6\r\n"),
        std::string("timestamp,wx,wy,wz,ax,ay,az\n100, 1, 2,3 ,4,5,6\n\n# note\n105,-1.5,0.2,3,4,5,"
                    "6\n")}) {
    const std::vector<ImuSample> samples = ReadImuTable(text, "data.csv");
    ASSERT_EQ(samples.size(), 2U);
    EXPECT_EQ(samples[0].timestamp, 100);
    EXPECT_EQ(samples[0].omega_m, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(samples[0].a_m, Eigen::Vector3d(4, 5, 6));
    EXPECT_EQ(samples[1].omega_m, Eigen::Vector3d(-1.5, 0.2, 3));
  }
}

struct BadTable {
  std::string text;
  std::string message;
};
class RefusedImuTable : public testing::TestWithParam<BadTable> {};

TEST_P(RefusedImuTable, NamesFileLineColumnAndWhatWasExpected) {
  EXPECT_THAT([] { (void)ReadImuTable(GetParam().text, "imu0/data.csv"); },
              ThrowsMessage<InputError>(StrEq("imu0/data.csv" + GetParam().message)));
}

INSTANTIATE_TEST_SUITE_P(
    Csv, RefusedImuTable,
    testing::Values(
        BadTable{"", ": is empty"}, BadTable{kImuHeader, ": has no rows"},
        BadTable{kImuHeader + kImuRow + "105,1,2,3", ":3: is truncated: the last line has no end"},
        BadTable{kImuHeader + kImuRow + "105,1,2,3,4,5,6",
                 ":3: is truncated: the last line has no end"},
        BadTable{kImuHeader + kImuRow + "105,1,2,3\n",
                 ":3: expected 7 columns, got 4; is the file truncated?"},
        BadTable{kImuHeader + "100,1,2,3\n" + kImuRow, ":2: expected 7 columns, got 4"},
        BadTable{kImuHeader + "100,1,2,3,4,5,6,7\n", ":2: expected 7 columns, got 8"},
        BadTable{kImuHeader + "100,1,2,3,4,5,6,\n", ":2: expected 7 columns, got 8"},
        BadTable{kImuHeader + "100,1,nan,3,4,5,6\n",
                 ":2: w_RS_S_y [rad s^-1]: expected a finite number, got 'nan'"},
        BadTable{kImuHeader + "100,1,2,3,4,inf,6\n",
                 ":2: a_RS_S_y [m s^-2]: expected a finite number, got 'inf'"},
        BadTable{kImuHeader + "100,1,,3,4,5,6\n",
                 ":2: w_RS_S_y [rad s^-1]: expected a finite number, got ''"},
        BadTable{kImuHeader + "100,1,2x,3,4,5,6\n",
                 ":2: w_RS_S_y [rad s^-1]: expected a finite number, got '2x'"},
        BadTable{kImuHeader + "1.5,1,2,3,4,5,6\n",
                 ":2: timestamp [ns]: expected an integer stamp in nanoseconds, got '1.5'"},
        BadTable{kImuHeader + "-5,1,2,3,4,5,6\n",
                 ":2: timestamp [ns]: expected an integer stamp in nanoseconds, got '-5'"},
        BadTable{kImuHeader + "9000000000000000000,1,2,3,4,5,6\n",
                 ":2: timestamp [ns]: expected an integer stamp in nanoseconds, got "
                 "'9000000000000000000'"},
        BadTable{kImuHeader + kImuRow + kImuRow,
                 ":3: timestamp [ns]: the stamp 100 stands twice; expected stamps that increase"},
        BadTable{kImuHeader + kImuRow + "99,1,2,3,4,5,6\n",
                 ":3: timestamp [ns]: time goes backwards by 0.000000001 s; expected stamps that "
                 "increase"},
        BadTable{std::string("100,1,2,3,4,5,6\n\0\n", 18), ": is no text: it contains a zero byte"},
        BadTable{"\x89PNG,1\n", ": has no rows"}));

TEST(ImuTable, WhatIsWrittenReadsBackToTheSameBits) {
  Random random(1);
  std::vector<ImuSample> samples(200);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    samples[i].timestamp = 1403636583763555584 + static_cast<Timestamp>(i) * 5000001;
    samples[i].omega_m = random.NormalVector<3>();
    samples[i].a_m = 9.81 * random.NormalVector<3>();
  }
  const std::vector<ImuSample> again = ReadImuTable(WriteImuTable(samples), "data.csv");
  ASSERT_EQ(again.size(), samples.size());
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(again[i].timestamp, samples[i].timestamp);
    EXPECT_EQ(again[i].omega_m, samples[i].omega_m);
    EXPECT_EQ(again[i].a_m, samples[i].a_m);
  }
}

TEST(ImageTable, ReadsNamesAndRefusesPaths) {
  const std::vector<ImageName> images =
      ReadImageTable("#timestamp [ns],filename\r\n5,5.png\r\n6,six six.png\r\n", "data.csv");
  ASSERT_EQ(images.size(), 2U);
  EXPECT_EQ(images[0].name, "5.png");
  EXPECT_EQ(images[1].timestamp, 6);
  EXPECT_EQ(images[1].name, "six six.png");
  for (const char* name : {"", "../5.png", "data/5.png", "..", "a\\b.png"}) {
    EXPECT_THAT([&] { (void)ReadImageTable("5," + std::string(name) + "\n", "data.csv"); },
                ThrowsMessage<InputError>(HasSubstr("data.csv:1: filename: expected the name")))
        << name;
  }
  EXPECT_THAT([&] { (void)ReadImageTable("5,5.png\n5,5.png\n", "data.csv"); },
              ThrowsMessage<InputError>(HasSubstr("stands twice")));
}

TEST(GroundTruthTable, ReadsEurocsSeventeenColumns) {
  const GroundTruth truth = ReadGroundTruthTable(
      "#t, p, ...\n"
      "10,1,2,3,0.5,0.5,-0.5,0.5,7,8,9,0.1,0.2,0.3,0.4,0.5,0.6\n"
      "20,1,2,3,1,0,0,0,7,8,9,0,0,0,0,0,0\n",
      "data.csv");
  ASSERT_EQ(truth.poses.size(), 2U);
  EXPECT_EQ(truth.poses[0].timestamp, 10);
  EXPECT_EQ(truth.poses[0].T_GB.p, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(truth.poses[0].T_GB.R.w(), 0.5);
  EXPECT_EQ(truth.poses[0].T_GB.R.vec(), Eigen::Vector3d(0.5, -0.5, 0.5));
  ASSERT_TRUE(truth.has_velocities());
  ASSERT_TRUE(truth.has_biases());
  EXPECT_EQ(truth.velocities[0], Eigen::Vector3d(7, 8, 9));
  EXPECT_EQ(truth.biases[0].b_g, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_EQ(truth.biases[0].b_a, Eigen::Vector3d(0.4, 0.5, 0.6));
  EXPECT_TRUE(truth.biases[1].b_g.isZero()) << "zero in one row is a bias of zero";
}

TEST(GroundTruthTable, ZerosInEveryRowMeanUnknown) {
  const std::string row = ",1,2,3,1,0,0,0,7,8,9,0,0,0,0,-0,0\n";
  const GroundTruth no_biases = ReadGroundTruthTable("10" + row + "20" + row, "data.csv");
  EXPECT_TRUE(no_biases.has_velocities());
  EXPECT_FALSE(no_biases.has_biases());
  const GroundTruth neither =
      ReadGroundTruthTable("10,1,2,3,1,0,0,0,0,0,0,0,0,0,0,0,0\n", "data.csv");
  EXPECT_FALSE(neither.has_velocities());
  EXPECT_FALSE(neither.has_biases());
}

TEST(GroundTruthTable, ReadsPosesAlone) {
  const GroundTruth truth = ReadGroundTruthTable("10,1,2,3,0,0,0,-1\n", "data.csv");
  EXPECT_EQ(truth.poses.at(0).T_GB.R.z(), -1.0) << "w x y z; the sign stays";
  EXPECT_FALSE(truth.has_velocities());
  EXPECT_FALSE(truth.has_biases());
}

TEST(GroundTruthTable, RefusesWhatIsNoRotationAndOtherShapes) {
  EXPECT_THAT([] { (void)ReadGroundTruthTable("10,1,2,3,1,0.1,0,0\n", "gt.csv"); },
              ThrowsMessage<InputError>(HasSubstr(
                  "gt.csv:1: q_RS_w []: is no rotation: expected a quaternion of length 1, got "
                  "length 1.00498")));
  EXPECT_THAT([] { (void)ReadGroundTruthTable("10,1,2,3,0,0,0,0\n", "gt.csv"); },
              ThrowsMessage<InputError>(HasSubstr("is no rotation")));
  EXPECT_THAT([] { (void)ReadGroundTruthTable("10,1,2,3\n", "gt.csv"); },
              ThrowsMessage<InputError>(StrEq("gt.csv:1: expected 17 or 8 columns, got 4")));
  EXPECT_THAT(
      [] { (void)ReadGroundTruthTable("10,1,2,3,1,0,0,0\n20,1,2,3,1,0,0,0,0\n", "gt.csv"); },
      ThrowsMessage<InputError>(HasSubstr("gt.csv:2: expected 8 columns, got 9")));
}

TEST(TumTrajectory, ReadsStampsExactly) {
  const GroundTruth truth = ReadTumTrajectory(
      "# timestamp tx ty tz qx qy qz qw\n"
      "1403636583.763555584 1 2 3 0 0 0 1\n"
      "1.403636583763555585e+09\t4 5 6   0.5 0.5 0.5 -0.5 \r\n",
      "a.tum");
  ASSERT_EQ(truth.poses.size(), 2U);
  EXPECT_EQ(truth.poses[0].timestamp, 1403636583763555584);
  EXPECT_EQ(truth.poses[1].timestamp, 1403636583763555585);
  EXPECT_EQ(truth.poses[1].T_GB.p, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(truth.poses[1].T_GB.R.w(), -0.5);
}

TEST(TumTrajectory, RefusesWhatItIsNot) {
  EXPECT_THAT([] { (void)ReadTumTrajectory("1 1 2 3 0 0 0 1\n1 1 2 3 0 0 0 1\n", "a.tum"); },
              ThrowsMessage<InputError>(StrEq("a.tum:2: t [s]: the stamp 1 stands twice; expected "
                                              "stamps that increase")));
  EXPECT_THAT([] { (void)ReadTumTrajectory("1 1 2 3 0 0 0\n", "a.tum"); },
              ThrowsMessage<InputError>(HasSubstr("a.tum:1: expected 8 columns, got 7")));
  EXPECT_THAT([] { (void)ReadTumTrajectory("x 1 2 3 0 0 0 1\ny 1 2 3 0 0 0 1\n", "a.tum"); },
              ThrowsMessage<InputError>(HasSubstr("a.tum:2: t [s]: expected a stamp in seconds")));
  EXPECT_THAT([] { (void)ReadTumTrajectory("1 1 2 3 0 0 0 nan\n", "a.tum"); },
              ThrowsMessage<InputError>(HasSubstr("a.tum:1: qw: expected a finite number")));
}

TEST(Trajectory, WhichFormIsSeenFromTheFirstRow) {
  EXPECT_EQ(ReadTrajectory("# a, b\n5 1 2 3 0 0 0 1\n", "f").poses.at(0).timestamp, 5000000000);
  EXPECT_EQ(ReadTrajectory("# a b\n5,1,2,3,1,0,0,0\n", "f").poses.at(0).timestamp, 5);
  EXPECT_THROW((void)ReadTrajectory("", "f"), InputError);
}

GroundTruth RandomTruth(int count) {
  Random random(2);
  std::vector<InertialState> states(static_cast<std::size_t>(count));
  Timestamp t = 1403636583763555584;
  for (InertialState& state : states) {
    state.instant = t += 5000001;
    state.nav.R_GB = Eigen::Quaterniond(random.NormalVector<4>().normalized());
    state.nav.p_GB = random.NormalVector<3>();
    state.nav.v_GB = random.NormalVector<3>();
    state.biases.b_g = random.NormalVector<3>();
    state.biases.b_a = random.NormalVector<3>();
  }
  return GroundTruthOf(states);
}

TEST(Trajectory, WhatIsWrittenReadsBackToTheSame) {
  const GroundTruth truth = RandomTruth(100);
  const GroundTruth asl = ReadTrajectory(WriteGroundTruthTable(truth), "gt.csv");
  const GroundTruth tum = ReadTrajectory(WriteTumTrajectory(truth.poses), "gt.tum");
  ASSERT_EQ(asl.poses.size(), truth.poses.size());
  ASSERT_EQ(tum.poses.size(), truth.poses.size());
  for (std::size_t i = 0; i < truth.poses.size(); ++i) {
    for (const GroundTruth* read : {&asl, &tum}) {
      EXPECT_EQ(read->poses[i].timestamp, truth.poses[i].timestamp);
      EXPECT_EQ(read->poses[i].T_GB.p, truth.poses[i].T_GB.p);
      // Normalizing once more moves the last bit.
      EXPECT_LT((read->poses[i].T_GB.R.coeffs() - truth.poses[i].T_GB.R.coeffs()).norm(), 1e-15);
    }
    EXPECT_EQ(asl.velocities[i], truth.velocities[i]);
    EXPECT_EQ(asl.biases[i].b_g, truth.biases[i].b_g);
    EXPECT_EQ(asl.biases[i].b_a, truth.biases[i].b_a);
  }
  EXPECT_THAT(WriteTumTrajectory(truth.poses), HasSubstr("\n1403636583.768555585 "));
}

}  // namespace
}  // namespace duet
