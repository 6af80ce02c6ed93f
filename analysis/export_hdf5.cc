#include <algorithm>
#include <string>
#include <string_view>

#include "pliant/analysis/export.h"
#include "pliant/analysis/hdf5_image.h"
#include "pliant/analysis/write_file.h"
#include "pliant/systems/error.h"

namespace pliant {

using namespace internal;

namespace {

/// "arm.measured_velocity" is "/arm/measured_velocity".
std::string GroupOf(const std::string& path) {
  std::string group = "/" + path;
  std::ranges::replace(group, '.', '/');
  if (path.empty() || path.find_first_of(std::string_view("/\0", 2)) != std::string::npos ||
      group.ends_with('/') || group.find("//") != std::string::npos)
    throw Error("a signal's path must be names with dots between them, got '" + path + "'");
  return group;
}

/// A signal in the group of another one must not have the name of what the other writes there.
void RequireDifferentPlaces(const Recording& recording) {
  for (const RecordedSignal& signal : recording.signals())
    for (const char* const name : {".time", ".data"}) {
      const std::string taken = signal.path + name;
      for (const RecordedSignal& other : recording.signals())
        if (other.path == taken || other.path.starts_with(taken + "."))
          throw Error("the numbers of '" + signal.path + "' and the signal '" + other.path +
                      "' would both be " + GroupOf(taken));
    }
}

void Write(const Recording& recording, hid_t file) {
  RequireDifferentPlaces(recording);
  for (const RecordedSignal& signal : recording.signals()) {
    const Handle group = MakeGroup(file, GroupOf(signal.path));
    WriteWord(group, "type", signal.type);
    WriteWords(group, "elements", signal.elements);
    WriteWords(group, "units", signal.units);
    const auto rows = static_cast<hsize_t>(signal.times.size());
    const auto elements = static_cast<hsize_t>(signal.numbers.rows());
    WriteNumbers(group, "time", signal.times.data(), rows, 0, "s");
    // A column for each time in memory is a row for each time in the file.
    if (elements > 0) WriteNumbers(group, "data", signal.numbers.data(), rows, elements, "");
  }
  for (const auto& [name, words] : recording.metadata()) {
    std::string place = name;
    std::ranges::replace(place, '/', '_');
    const Handle group = MakeGroup(file, "/metadata/" + (place.empty() ? "_" : place));
    for (const auto& [key, word] : words) WriteWord(group, key.empty() ? "_" : key, word);
  }
  if (!recording.robot_description().empty())
    WriteWord(file, "robot_description", recording.robot_description());
}

}  // namespace

void ExportHdf5(const Recording& recording, const std::filesystem::path& file, bool force) {
  RequireNewFile(file, force);
  std::string image;
  try {
    image = Hdf5Image([&](hid_t out) { Write(recording, out); });
  } catch (const Error& error) {
    throw Error("cannot write " + file.string() + ": " + error.what());
  }
  PartFile part(file);
  part.Write(image);
  part.MoveIntoPlace();
}

}  // namespace pliant
