#pragma once

namespace duet {

struct MsckfOptions {};

}  // namespace duet
