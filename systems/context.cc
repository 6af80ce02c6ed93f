#include "pliant/systems/context.h"

#include <algorithm>
#include <new>
#include <utility>

namespace pliant {

using internal::Role;
using internal::Slot;

Context::Context(const internal::Plan* plan)
    : plan_{plan},
      arena_{static_cast<std::byte*>(
          ::operator new (plan->bytes, std::align_val_t{plan->alignment}))} {
  std::memset(arena_ + plan_->valid_offset, 0, plan_->bytes - plan_->valid_offset);
}

void Context::Construct(const void* from) {
  const Slot& slot = plan_->slots[constructed_];
  slot.type->construct(arena_ + slot.offset, from);
  ++constructed_;
}

Context::Context(const internal::Plan& plan) : Context(&plan) {
  for (const Slot& slot : plan_->slots) Construct(slot.initial);
  for (std::size_t i = 0; i < plan_->continuous.size(); ++i) StoreState(static_cast<int>(i));
  ResetValid();
  for (const internal::Rate& rate : plan_->rates) line_.due.push_back(rate.offset.Times(1));
  line_.next_tick.assign(plan_->rates.size(), 0);
  line_.side.assign(plan_->guards.size(), 0);
  line_.fired.assign(plan_->guards.size(), -1e300);
  line_.quick.assign(plan_->guards.size(), 0);
}

Context::Context(const Context& other) : Context(other.plan_) {
  for (const Slot& slot : plan_->slots)
    Construct(slot.role == Role::Scratch ? slot.initial : other.arena_ + slot.offset);
  line_ = other.line_;
  CopyBehindValues(other);
}

Context::Context(Context&& other) noexcept
    : plan_{other.plan_},
      arena_{std::exchange(other.arena_, nullptr)},
      constructed_{std::exchange(other.constructed_, 0)},
      line_{std::move(other.line_)},
      rules_run_{other.rules_run_} {}

Context& Context::operator=(Context&& other) noexcept {
  std::swap(plan_, other.plan_);
  std::swap(arena_, other.arena_);
  std::swap(constructed_, other.constructed_);
  std::swap(line_, other.line_);
  std::swap(rules_run_, other.rules_run_);
  return *this;
}

Context& Context::operator=(const Context& other) {
  if (this == &other) return *this;
  if (!arena_) return *this = Context(other);
  Require(plan_ == other.plan_, "a context is assigned from one of the same diagram");
  for (const Slot& slot : plan_->slots)
    if (slot.role != Role::Scratch)
      slot.type->assign(arena_ + slot.offset, other.arena_ + slot.offset);
  line_ = other.line_;
  CopyBehindValues(other);
  return *this;
}

Context::~Context() {
  if (!arena_) return;
  for (std::size_t i = 0; i < constructed_; ++i)
    plan_->slots[i].type->destroy(arena_ + plan_->slots[i].offset);
  ::operator delete (arena_, std::align_val_t{plan_->alignment});
}

/// Validity bits and state vector.
void Context::CopyBehindValues(const Context& other) {
  std::memcpy(arena_ + plan_->valid_offset, other.arena_ + plan_->valid_offset,
              plan_->bytes - plan_->valid_offset);
}

/// Only held outputs hold.
void Context::ResetValid() {
  const internal::Bits& held = plan_->initially_valid;
  std::fill_n(Valid(), plan_->words, 0);
  std::copy_n(plan_->pool.data() + held.pool, held.size, Valid() + held.first);
}

bool Context::operator==(const Context& other) const {
  if (plan_ != other.plan_ || !(line_ == other.line_)) return false;
  for (const Slot& slot : plan_->slots) {
    if (slot.role == Role::Scratch || slot.role == Role::Computed || slot.role == Role::Rate ||
        slot.role == Role::Next)
      continue;
    if (!slot.type->equal)
      throw Error("cannot compare " + slot.value->describe() +
                  "\ngive its type an operator== or a function template Fields");
    if (!slot.type->equal(arena_ + slot.offset, other.arena_ + slot.offset)) return false;
  }
  return true;
}

std::size_t Context::bytes() const {
  return plan_->bytes + sizeof(*this) + line_.next_tick.size() * 2 * sizeof(std::int64_t) +
         line_.side.size() * (2 * sizeof(double) + sizeof(int));
}

void Context::ThrowNotHere(const internal::Value& value) const {
  throw Error(value.path() +
              " is not a value of this diagram; build the diagram with its block, and read it "
              "through a context of that diagram");
}

void Context::ThrowShape(const internal::Value& value, Eigen::Index expected, Eigen::Index found) {
  throw Error("cannot set " + value.describe() + ": it has " + Text(expected) + " numbers, got " +
              Text(found));
}

void Context::ThrowNotSettable(const internal::Value& value) {
  const auto& declared = internal::Access::Of(value);
  const bool wired = !declared.from.empty();
  const bool workspace = declared.kind == internal::Kind::Scratch;
  throw Error("cannot set " + value.describe() +
              (wired       ? ": it is connected"
               : workspace ? ": it is a workspace"
                           : ": it follows from other values"));
}

void Context::GetNumbers(const internal::Value& value, std::span<double> numbers) {
  Check(value);
  CheckNumbers(value, numbers.size());
  const std::int32_t rule = internal::Access::RuleOf(value);
  if (rule >= 0 && !IsValid(rule)) Evaluate(plan_->needs[static_cast<std::size_t>(rule)]);
  internal::Access::TypeOf(value).store(arena_ + internal::Access::Offset(value), numbers.data(),
                                        numbers.size());
}

void Context::SetNumbers(const internal::Value& value, std::span<const double> numbers) {
  CheckSettable(value);
  CheckNumbers(value, numbers.size());
  internal::Access::TypeOf(value).set_numbers(arena_ + internal::Access::Offset(value),
                                              numbers.data());
  Changed(value);
}

void Context::CheckNumbers(const internal::Value& value, std::size_t count) const {
  const internal::ValueType* type = internal::Access::Of(value).type;
  if (!type || !type->write || internal::Access::Of(value).kind == internal::Kind::InputList)
    throw Error(value.describe() +
                " is not made of numbers\ngive its type a function template Fields");
  const std::size_t expected = type->count(arena_ + internal::Access::Offset(value));
  if (count != expected)
    throw Error(value.describe() + " has " + Text(expected) + " numbers, got " + Text(count));
}

namespace {

/// The numbers of a state or its rate, which has the size that the state has had from the start.
void StoreNumbers(const internal::ContinuousEntry& entry, const internal::ValueType& type,
                  const void* value, double* to, const char* whose) {
  if (!type.store(value, to, static_cast<std::size_t>(entry.size)))
    throw Error(std::string(whose) + entry.value->describe() + " has " + Text(entry.size) +
                " numbers, but its rule gave " + Text(type.count(value)));
}

}  // namespace

void Context::StoreState(int continuous) {
  const internal::ContinuousEntry& entry = plan_->continuous[static_cast<std::size_t>(continuous)];
  StoreNumbers(entry, *entry.type, arena_ + entry.offset, StateData() + entry.first, "");
}

void Context::Derivatives(std::span<double> rates) {
  Require(rates.size() == state().size(), "there is a rate for each state", rates.size());
  Evaluate(plan_->derivatives);
  StoreRates(rates);
}

void Context::StoreRates(std::span<double> rate) const {
  for (const internal::ContinuousEntry& entry : plan_->continuous)
    StoreNumbers(entry, *entry.rate_type, arena_ + entry.rate_offset, rate.data() + entry.first,
                 "the rate of ");
}

void Context::CommitUpdates(const internal::Happening& h) {
  for (const internal::Commit& c : h.commits) {
    c.type->assign(arena_ + c.to, arena_ + c.from);
    Invalidate(plan_->sources[static_cast<std::size_t>(c.source)]);
    if (c.continuous >= 0) StoreState(c.continuous);
  }
}

/// To another time and state; nothing becomes stale if they are what they were.
void Context::MoveTo(double t, std::span<const double> state) {
  if (time() == t && std::memcmp(state.data(), StateData(), state.size_bytes()) == 0) return;
  SetTime(t);
  std::ranges::copy(state, StateData());
  for (const internal::ContinuousEntry& entry : plan_->continuous)
    entry.type->set_numbers(arena_ + entry.offset, state.data() + entry.first);
  Invalidate(plan_->moving_dependents);
}

}  // namespace pliant
