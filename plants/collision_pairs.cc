#include "pliant/plants/collision_pairs.h"

#include "pliant/plants/parameter_file.h"

namespace pliant {

namespace {

CollisionPairs From(const ParameterFile& file, const RobotModel& model) {
  CollisionPairs pairs;
  file.Fill(pairs);
  std::vector<std::string> known;
  for (const Link& link : model.links()) known.push_back(link.name);
  for (const std::string& name : pairs.optional) known.push_back(name);
  for (const char* list : {"watch", "ignore"})
    if (const auto groups = file.Find(list))
      for (const ParameterFile& group : groups->elements())
        for (const auto& [side, names] : group.entries())
          for (const ParameterFile& name : names.elements()) name.OneOf(known);
  return pairs;
}

}  // namespace

CollisionPairs CollisionPairs::Read(const std::filesystem::path& file, const RobotModel& model) {
  return From(ParameterFile::Read(file), model);
}

CollisionPairs CollisionPairs::ReadText(const std::string& text, const RobotModel& model,
                                        const std::string& source) {
  return From(ParameterFile::ReadText(text, source), model);
}

}  // namespace pliant
