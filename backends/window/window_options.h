#pragma once

namespace duet {

struct WindowOptions {};

}  // namespace duet
