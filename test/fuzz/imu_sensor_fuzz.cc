#include "common/dataset/asl_sensors.h"
#include "common/support/logging.h"
#include "test/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    std::vector<std::string> unknown;
    const duet::ImuSensor sensor = duet::ReadImuSensor(text, "f", &unknown);
    const duet::ImuSensor again = duet::ReadImuSensor(duet::WriteImuSensor(sensor), "g");
    CHECK(again.calibration.T_g == sensor.calibration.T_g);
  });
}
