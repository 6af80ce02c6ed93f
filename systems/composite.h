#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "pliant/systems/block.h"

namespace pliant {

namespace internal {

/// An error in the constructor of the block `path`, seen from the composite that adds it.
struct BlockError : Error {
  BlockError(std::string where, std::string what)
      : Error(where + ": " + what), path{std::move(where)}, reason{std::move(what)} {}
  std::string path, reason;
};

}  // namespace internal

/// A block made of blocks. Its constructor adds the parts and the wires between them; its own ports
/// are wired inside like any other: its Inputs feed parts, parts feed its Outputs. A built diagram
/// is flat, so nesting costs nothing.
class Composite : public Block {
 protected:
  Composite() = default;

  /// Constructs a T from its Options (or any arguments) as the part `name`.
  template <class T>
  T& Add(std::string name, const typename T::Options& options) {
    return static_cast<T&>(Adopt(
        std::move(name), [&]() -> std::unique_ptr<Block> { return std::make_unique<T>(options); }));
  }
  template <class T, class... A>
  T& Add(std::string name, A&&... arguments) {
    return static_cast<T&>(Adopt(std::move(name), [&]() -> std::unique_ptr<Block> {
      return std::make_unique<T>(std::forward<A>(arguments)...);
    }));
  }

  template <class S>
  void Connect(const Output<S>& from, Input<S>& to) {
    Wire(from, to);
  }
  template <class S>
  void Connect(const Output<S>& from, InputList<S>& to) {
    Wire(from, to);
  }
  /// From an Input of this composite to a part.
  template <class S>
  void Connect(const Input<S>& from, Input<S>& to) {
    Wire(from, to);
  }
  template <class S>
  void Connect(const Input<S>& from, InputList<S>& to) {
    Wire(from, to);
  }
  template <class S>
  void Connect(const InputList<S>& from, InputList<S>& to) {
    Wire(from, to);
  }
  /// From a part, or from an Input passed through, to an Output of this composite.
  template <class S>
  void Connect(const Output<S>& from, Output<S>& to) {
    Wire(from, to);
  }
  template <class S>
  void Connect(const Input<S>& from, Output<S>& to) {
    Wire(from, to);
  }
  void Connect(const internal::Value& from, AnyInputs& to) { Wire(from, to); }

  template <class A, class B>
  requires(!std::is_same_v<B, AnyInputs> &&
           !std::is_same_v<typename A::Signal, typename B::Signal>) void Connect(const A&, B&) {
    static_assert(!std::is_same_v<A, A>,
                  "Connect(from, to): the ports carry different physical quantities");
  }

 private:
  friend class internal::PlanBuilder;
  friend struct internal::Plan;
  friend struct internal::Access;

  template <class Make>
  Block& Adopt(std::string name, const Make& make) {
    internal::CheckName("a block", name);
    try {
      return Keep(std::move(name), make());
    } catch (const internal::BlockError& e) {
      throw internal::BlockError(name + "." + e.path, e.reason);
    } catch (const Error& e) {
      throw internal::BlockError(name, e.what());
    }
  }
  Block& Keep(std::string name, std::unique_ptr<Block> part);
  void Wire(const internal::Value& from, const internal::Value& to);

  std::vector<std::unique_ptr<Block>> parts_;
};

}  // namespace pliant
