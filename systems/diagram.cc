#include "pliant/systems/diagram.h"

namespace pliant {

Diagram DiagramBuilder::Build() {
  root();
  return Diagram(internal::MakePlan(std::move(root_)));
}

std::vector<std::string> Diagram::BlockPaths() const {
  std::vector<std::string> paths;
  for (const Block* block : plan_->blocks)
    if (block != plan_->root.get()) paths.push_back(block->path());
  return paths;
}

std::vector<ValueInfo> Diagram::Values() const {
  using internal::Access;
  using internal::Kind;
  std::vector<ValueInfo> values;
  for (const Block* block : plan_->blocks)
    for (const auto& declared : Access::Values(*block)) {
      const std::int32_t rule = Access::RuleOf(*declared.value);
      const bool held = rule >= 0 && plan_->rule_names[static_cast<std::size_t>(rule)].rule->kind ==
                                         internal::RuleKind::Held;
      std::string kind;
      switch (declared.kind) {
        case Kind::Input:
          kind = "input";
          break;
        case Kind::InputList:
          kind = "input list";
          break;
        case Kind::Output:
          kind = held ? "held output" : "output";
          break;
        case Kind::Discrete:
          kind = "discrete";
          break;
        case Kind::Continuous:
          kind = "continuous";
          break;
        case Kind::Scratch:
          kind = "scratch";
          break;
      }
      values.push_back({declared.value->path(), kind, declared.type ? declared.type->name : "any",
                        declared.type ? declared.type->unit : "", declared.space.text()});
    }
  return values;
}

}  // namespace pliant
