#include "pliant/systems/composite.h"

#include <algorithm>

namespace pliant {

namespace {

bool Contains(const Composite* whole, const Block* part, const Composite* parent) {
  return static_cast<const Block*>(whole) == part || parent == whole;
}

}  // namespace

void Composite::CheckName(const std::string& name) const {
  if (name.empty() || name.find_first_of(". []") != std::string::npos)
    throw Error("a block's name is not empty and has no dot, space or bracket, got '" + name + "'");
}

std::string Composite::PathOf(const std::string& part) const {
  const std::string above = path();
  return above.empty() ? part : above + "." + part;
}

Block& Composite::Keep(std::string name, std::unique_ptr<Block> part) {
  part->name_ = std::move(name);
  part->parent_ = this;
  parts_.push_back(std::move(part));
  return *parts_.back();
}

void Composite::Wire(const internal::Value& from, const internal::Value& to) {
  const auto ends = [&] { return "\n  from  " + from.describe() + "\n  to    " + to.describe(); };
  for (const internal::Value* end : {&from, &to})
    if (!Contains(this, end->block_, end->block_->parent_))
      throw Error("cannot connect: " + end->path() + " is not a port of this diagram or of a part of it" +
                  ends() + "\nadd its block to this diagram, or export the port of the inner one");

  const Declared& source = from.block_->values_[static_cast<std::size_t>(from.index_)];
  Declared& sink = to.block_->values_[static_cast<std::size_t>(to.index_)];
  if (source.kind == internal::Kind::Input && from.block_ != this)
    throw Error("cannot connect: an Input of a part is no source" + ends());
  if (sink.kind == internal::Kind::Output && to.block_ != this)
    throw Error("cannot connect: an Output of a part is no destination" + ends());

  const bool both = !source.space.empty() && !sink.space.empty();
  if (both && source.space.size() != sink.space.size())
    throw Error("cannot connect: the ports have different sizes, " + Text(source.space.size()) +
                " and " + Text(sink.space.size()) + ends());
  if (both && !(source.space == sink.space))
    throw Error(std::string("cannot connect: the ports are about different ") +
                (source.space.size() ? "joints" : "frames") + ends());

  if (sink.kind != internal::Kind::InputList && !sink.from.empty()) {
    const Block::Wire& first = sink.from.front();
    throw Error("cannot connect: the port is connected already\n  from  " +
                first.block->values_[static_cast<std::size_t>(first.value)].value->describe() + "\n  and   " +
                from.describe() + "\n  to    " + to.describe() +
                "\nremove one of the wires, or give the block an InputList");
  }
  sink.from.push_back({from.block_, from.index_});
}

}  // namespace pliant
