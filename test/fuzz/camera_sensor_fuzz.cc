#include "common/dataset/asl_sensors.h"
#include "common/support/logging.h"
#include "test/fuzz/fuzz_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    std::vector<std::string> unknown;
    const duet::CameraSensor sensor = duet::ReadCameraSensor(text, "f", &unknown);
    const duet::CameraSensor again = duet::ReadCameraSensor(duet::WriteCameraSensor(sensor), "g");
    CHECK(again.calibration.model.parameters() == sensor.calibration.model.parameters());
    CHECK(again.calibration.p_CB == sensor.calibration.p_CB);
  });
}
