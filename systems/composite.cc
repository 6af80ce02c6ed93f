#include "pliant/systems/composite.h"

#include "pliant/systems/plan.h"

namespace pliant {

namespace internal {

std::string Ends(const Value& from, const Value& to) {
  return "\n  from  " + from.describe() + "\n  to    " + to.describe();
}

void CheckSpaces(const Value& from, const Value& to) {
  const Space &source = Access::Of(from).space, &sink = Access::Of(to).space;
  if (source.empty() || sink.empty() || source == sink) return;
  if (source.size() != sink.size())
    throw Error("cannot connect: the ports have different sizes, " + Text(source.size()) + " and " +
                Text(sink.size()) + Ends(from, to));
  throw Error(std::string("cannot connect: the ports are about different ") +
              (source.size() ? "joints" : "frames") + Ends(from, to));
}

}  // namespace internal

Block& Composite::Keep(std::string name, std::unique_ptr<Block> part) {
  part->name_ = std::move(name);
  part->parent_ = this;
  parts_.push_back(std::move(part));
  return *parts_.back();
}

void Composite::Wire(const internal::Value& from, const internal::Value& to) {
  using internal::Kind;
  const auto refuse = [&](const std::string& why, const std::string& way_out = "") {
    throw Error("cannot connect: " + why + internal::Ends(from, to) + way_out);
  };
  // Whoever looks on, as a recorder does, may look at any part of a part.
  const bool looks_on = to.block_->values_[static_cast<std::size_t>(to.index_)].type == nullptr;
  const Block* part = from.block_;
  while (looks_on && part->parent_ && part->parent_ != this) part = part->parent_;
  const bool seen = looks_on && part->parent_ == this;
  for (const internal::Value* end : {&from, &to})
    if (end->block_ != this && end->block_->parent_ != this && !(end == &from && seen))
      refuse(end->path() + " is not a port of this diagram or of a part of it",
             "\nadd its block to this diagram, or export the port of the inner one");

  const Declared& source = from.block_->values_[static_cast<std::size_t>(from.index_)];
  Declared& sink = to.block_->values_[static_cast<std::size_t>(to.index_)];
  if ((source.kind == Kind::Input || source.kind == Kind::InputList) && from.block_ != this)
    refuse("an Input of a part is no source");
  if ((sink.kind == Kind::Output) != (to.block_ == this))
    refuse(sink.kind == Kind::Output ? "an Output of a part is no destination"
                                     : "an Input is wired from outside of its block");
  internal::CheckSpaces(from, to);
  if (sink.kind != Kind::InputList && !sink.from.empty()) {
    const Block::Wire& first = sink.from.front();
    const auto& other = *first.block->values_[static_cast<std::size_t>(first.value)].value;
    throw Error("cannot connect: the port is connected already\n  from  " + other.describe() +
                "\n  and   " + from.describe() + "\n  to    " + to.describe() +
                "\nremove one of the wires, or give the block an InputList");
  }
  sink.from.push_back({from.block_, from.index_});
}

}  // namespace pliant
