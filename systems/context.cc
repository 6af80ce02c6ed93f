#include "pliant/systems/context.h"

#include <new>

namespace pliant {

using internal::Role;
using internal::Slot;

namespace {
constexpr std::align_val_t kAlignment{64};
}

Context::Context(const internal::Plan& plan) : plan_{&plan} {
  Allocate();
  for (const Slot& slot : plan_->slots) slot.type->construct(arena_ + slot.offset, slot.initial);
  for (std::size_t i = 0; i < plan_->continuous.size(); ++i) StoreState(static_cast<int>(i));
  const internal::Bits& valid = plan_->initially_valid;
  std::memcpy(Valid() + valid.first, plan_->pool.data() + valid.pool, valid.size * sizeof(std::uint64_t));
  for (const internal::Rate& rate : plan_->rates) {
    line_.next_tick.push_back(0);
    line_.due.push_back(rate.offset.Times(1));
  }
  line_.side.assign(plan_->guards.size(), 0);
  line_.fired.assign(plan_->guards.size(), -1e300);
  line_.quick.assign(plan_->guards.size(), 0);
}

Context::Context(const Context& other) : plan_{other.plan_}, line_{other.line_} {
  Allocate();
  for (const Slot& slot : plan_->slots)
    slot.type->construct(arena_ + slot.offset,
                         slot.role == Role::Scratch ? slot.initial : other.arena_ + slot.offset);
  CopyValues(other);
}

Context::Context(Context&& other) noexcept
    : plan_{other.plan_}, arena_{other.arena_}, line_{std::move(other.line_)}, rules_run_{other.rules_run_} {
  other.arena_ = nullptr;
}

Context& Context::operator=(const Context& other) {
  if (this == &other) return *this;
  Require(plan_ == other.plan_, "a context is assigned from one of the same diagram");
  for (const Slot& slot : plan_->slots)
    if (slot.role != Role::Scratch)
      slot.type->assign(arena_ + slot.offset, other.arena_ + slot.offset);
  line_ = other.line_;
  CopyValues(other);
  return *this;
}

Context::~Context() {
  if (!arena_) return;
  for (const Slot& slot : plan_->slots) slot.type->destroy(arena_ + slot.offset);
  ::operator delete(arena_, kAlignment);
}

void Context::Allocate() {
  arena_ = static_cast<std::byte*>(::operator new(plan_->bytes, kAlignment));
  std::memset(arena_ + plan_->valid_offset, 0, plan_->bytes - plan_->valid_offset);
}

/// The part of the arena behind the values: validity bits and state vector.
void Context::CopyValues(const Context& other) {
  std::memcpy(arena_ + plan_->valid_offset, other.arena_ + plan_->valid_offset,
              plan_->bytes - plan_->valid_offset);
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
  return plan_->bytes + sizeof(*this) +
         line_.next_tick.size() * 2 * sizeof(std::int64_t) +
         line_.side.size() * (2 * sizeof(double) + sizeof(int));
}

void Context::ThrowNotHere(const internal::Value& value) const {
  throw Error(value.path() + " is not a value of this diagram; build the diagram with its block, and read it through "
              "a context of that diagram");
}

void Context::CheckSettable(const internal::Value& value) const {
  Check(value);
  if (internal::Access::Source(value) < 0)
    throw Error("cannot set " + value.describe() + ": it follows from other values");
  if (internal::Access::Of(value).kind == internal::Kind::Input && !internal::Access::Of(value).from.empty() &&
      internal::Access::RuleOf(value) >= 0)
    throw Error("cannot set " + value.describe() + ": it is connected");
}

void Context::Changed(const internal::Value& value) {
  Invalidate(plan_->sources[static_cast<std::size_t>(internal::Access::Source(value))]);
  for (std::size_t i = 0; i < plan_->continuous.size(); ++i)
    if (plan_->continuous[i].value == &value) StoreState(static_cast<int>(i));
}

void Context::LoadState(const double* x) {
  for (const internal::ContinuousEntry& entry : plan_->continuous)
    entry.type->set_numbers(arena_ + entry.offset, x + entry.first);
}

void Context::StoreState(int continuous) {
  const internal::ContinuousEntry& entry = plan_->continuous[static_cast<std::size_t>(continuous)];
  entry.type->store(arena_ + entry.offset, StateData() + entry.first);
}

void Context::CommitUpdates(const internal::Happening& h) {
  for (const internal::Commit& c : h.commits) {
    c.type->assign(arena_ + c.to, arena_ + c.from);
    if (c.continuous >= 0) StoreState(c.continuous);
  }
  for (const internal::Commit& c : h.commits)
    Invalidate(plan_->sources[static_cast<std::size_t>(c.source)]);
}

bool Context::Holds(double t, const double* x) {
  return time() == t &&
         std::memcmp(x, StateData(), static_cast<std::size_t>(plan_->states) * sizeof(double)) == 0;
}

}  // namespace pliant
