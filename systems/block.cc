#include "pliant/systems/block.h"

#include <algorithm>
#include <cctype>

#include "pliant/systems/composite.h"

namespace pliant {

namespace internal {

void CheckName(std::string_view whose, const std::string& name) {
  const auto is_fine = [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; };
  if (name.empty() || !std::ranges::all_of(name, is_fine))
    throw Error("the name of " + std::string(whose) + " has letters, digits, '_' and '-', got '" +
                name + "'");
}

Value::Value(Block* block, std::string_view name, Kind kind, const ValueType* type,
             const Space& space, std::shared_ptr<const void> initial, const ValueType* rate_type,
             std::shared_ptr<const void> rate)
    : block_{block}, index_{static_cast<int>(block->values_.size())} {
  CheckName("a value", std::string(name));
  for (const Block::Declared& other : block->values_)
    if (other.name == name) throw Error("two values are named '" + std::string(name) + "'");
  block->values_.push_back({kind,
                            std::string(name),
                            type,
                            space,
                            std::move(initial),
                            this,
                            rate_type,
                            std::move(rate),
                            {},
                            nullptr,
                            nullptr,
                            -1});
}

void Value::StandIn(std::shared_ptr<const void> value) {
  block_->values_[static_cast<std::size_t>(index_)].stand_in = std::move(value);
}

void Value::ShapedBy(const Value& inputs, Shape shape) {
  Block::Declared& declared = block_->values_[static_cast<std::size_t>(index_)];
  declared.shaped_by = block_->IndexOf(inputs);
  declared.shape = std::move(shape);
}

const std::string& Value::name() const {
  return block_->values_[static_cast<std::size_t>(index_)].name;
}

std::string Value::path() const {
  const std::string block = block_->path();
  return block.empty() ? name() : block + "." + name();
}

std::string Value::describe() const {
  const Block::Declared& declared = block_->values_[static_cast<std::size_t>(index_)];
  std::string text = path() + " : " + (declared.type ? declared.type->name : "any values");
  if (declared.type && !declared.type->unit.empty()) text += " [" + declared.type->unit + "]";
  const std::string space = declared.space.text();
  return space.empty() ? text : text + " " + space;
}

}  // namespace internal

std::string Block::path() const {
  if (!parent_) return name_;
  const std::string above = parent_->path();
  return above.empty() ? name_ : above + "." + name_;
}

internal::Rule Block::NewRule(internal::RuleKind kind, const internal::Value& target) const {
  internal::Rule rule;
  rule.kind = kind;
  rule.targets = {IndexOf(target)};
  return rule;
}

int Block::IndexOf(const internal::Value& value) const {
  if (value.block_ != this)
    throw Error("a rule reads and writes values of its own block, but '" + value.name() +
                "' belongs to another; connect an Input instead");
  return value.index_;
}

Block::PeriodicEvent Block::Every(Duration period, Duration offset) {
  if (!(Duration{} < period)) throw Error("a period must be > 0, got " + period.text());
  if (offset < Duration{}) throw Error("an offset must be >= 0, got " + offset.text());
  internal::Rule rule;
  rule.trigger = internal::Trigger::Periodic;
  rule.period = period;
  rule.offset = offset;
  return {this, std::move(rule)};
}

internal::Rule Block::TimedEvent::MakeStop(std::string reason) const {
  Require(!reason.empty(), "a rule that stops a run says why; give it a reason");
  internal::Rule rule = rule_;
  rule.kind = internal::RuleKind::Stop;
  rule.reason = std::move(reason);
  return rule;
}

void Block::TimedEvent::Stop(std::string reason) const {
  StopIf(std::move(reason)).From().As([] { return true; });
}

Block::Guard Block::When(const Output<double>& guard) {
  internal::Rule rule;
  rule.trigger = internal::Trigger::Guard;
  rule.guard = IndexOf(guard);
  return {this, std::move(rule)};
}

Block::Event Block::AtStart() {
  internal::Rule rule;
  rule.trigger = internal::Trigger::Start;
  return {this, std::move(rule)};
}

Block::Event Block::AtEveryStep() {
  internal::Rule rule;
  rule.trigger = internal::Trigger::Step;
  return {this, std::move(rule)};
}

}  // namespace pliant
