#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/systems/composite.h"
#include "pliant/systems/context.h"

namespace pliant {

/// A value of a diagram as lists and pictures name it.
struct ValueInfo {
  std::string path;
  std::string kind;  ///< input, output, held output, discrete, continuous, scratch
  std::string type;
  std::string unit;
  std::string space;
};

struct Part;

/// Blocks and wires, checked and put in order. It does not change: contexts hold what does, and
/// threads may share it.
class Diagram {
 public:
  Diagram(Diagram&&) noexcept = default;
  Diagram& operator=(Diagram&&) noexcept = default;

  Context MakeContext() const { return Context(*plan_); }

  /// All blocks by path, in order of declaration; composites before their parts.
  std::vector<std::string> BlockPaths() const;
  std::vector<ValueInfo> Values() const;

  /// The picture of blocks and wires, composites as boxes.
  std::string Graphviz() const;
  std::string Mermaid() const;

  const internal::Plan& plan() const { return *plan_; }

 private:
  friend class DiagramBuilder;
  explicit Diagram(std::unique_ptr<internal::Plan> plan) : plan_{std::move(plan)} {}
  std::unique_ptr<internal::Plan> plan_;
};

/// Collects parts and wires, then builds.
///
///   DiagramBuilder b;
///   auto& step = b.Add<Constant<JointVelocity>>("step", {.space = joints, .value = {1.0, -2.0}});
///   auto& filter = b.Add<LowPass<JointVelocity>>("filter", {…});
///   b.Connect(step.y, filter.u);
///   const Diagram diagram = b.Build();
class DiagramBuilder {
 public:
  DiagramBuilder() : root_{std::make_unique<Root>()} {}

  template <class T>
  T& Add(std::string name, const typename T::Options& options) {
    return root().template Add<T>(std::move(name), options);
  }
  template <class T, class... A>
  T& Add(std::string name, A&&... arguments) {
    return root().template Add<T>(std::move(name), std::forward<A>(arguments)...);
  }
  template <class A, class B>
  void Connect(const A& from, B& to) {
    root().Connect(from, to);
  }

  /// Flattens and checks. The builder is empty afterwards.
  Diagram Build();

  /// Sees values at every tick as recorders see them: held outputs new, states before updates.
  using Watch = std::function<void(double t, const AnyValues& values)>;

  /// Builds the block or composite `path` by itself: see part.h. `known` are the paths of values
  /// that will be given to it, or compared with what it computes; `watch` sees the latter in the
  /// order of Part::computed. The builder is empty afterwards.
  Part BuildPart(std::string_view path, const std::vector<std::string>& known, Watch watch = {});

 private:
  struct Root final : Composite {
    using Composite::Add;
    using Composite::Connect;
  };
  Root& root() {
    if (!root_) throw Error("the diagram is built already; start with a new DiagramBuilder");
    return *root_;
  }
  std::unique_ptr<Root> root_;
};

}  // namespace pliant
