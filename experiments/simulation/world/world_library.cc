#include "experiments/simulation/world/world_library.h"

#include "common/support/input_error.h"
#include "common/support/nearest_name.h"
#include "experiments/simulation/world/worlds.h"

namespace duet {
namespace {

[[noreturn]] void ThrowUnknown(const std::string& name) {
  std::string known;
  for (const std::string& world : WorldNames()) known += (known.empty() ? "" : ", ") + world;
  throw InputError("no world is called '" + name + "' (there are " + known + ")" +
                   DidYouMean(name, WorldNames()));
}

}  // namespace

const std::vector<std::string>& WorldNames() {
  static const std::vector<std::string> names = {"room", "bare_room", "hall", "street"};
  return names;
}

std::shared_ptr<const World> MakeWorld(const std::string& name, const WorldOptions& options) {
  if (name == "room") return MakeRoomWorld(name, options, false);
  if (name == "bare_room") return MakeRoomWorld(name, options, true);
  if (name == "hall") return MakeHallWorld(name, options);
  if (name == "street") return MakeStreetWorld(name, options);
  ThrowUnknown(name);
}

FlightSpace FlightSpaceOf(const std::string& world_name) {
  if (world_name == "room" || world_name == "bare_room") {
    return {{-3.2, -2.8, 0.6}, {3.2, 2.8, 2.5}};
  }
  if (world_name == "hall") return {{-9.0, -5.0, 0.8}, {9.0, 5.0, 4.5}};
  if (world_name == "street") return {{-70.0, -2.5, 0.5}, {70.0, 2.5, 3.0}};
  ThrowUnknown(world_name);
}

}  // namespace duet
