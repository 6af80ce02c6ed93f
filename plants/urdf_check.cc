#include <tinyxml.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "pliant/plants/urdf.h"
#include "pliant/systems/error.h"

namespace pliant::internal {
namespace {

using Element = TiXmlElement;

std::string Quoted(const std::string& s) { return '"' + s + '"'; }
std::string Tag(const Element& e) { return '<' + e.ValueStr() + '>'; }

std::optional<double> Number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double x = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), x);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(x)) return {};
  return x;
}

class Check {
 public:
  Check(const std::string& text, const std::string& source) : source_{source} {
    document_.Parse(Padded(text).c_str(), nullptr, TIXML_ENCODING_UTF8);
    if (document_.Error()) {
      const int row = document_.ErrorRow();
      throw Error(source_ + (row > 0 ? ":" + Text(row) : "") +
                  ": this is not well-formed XML: " + document_.ErrorDesc());
    }
    Require(document_.RootElement() != nullptr, source_ + ": expected a <robot> element, got none");
  }

  void Run() {
    const Element* root = document_.RootElement();
    if (root->ValueStr() != "robot")
      Fail(*root, "expected <robot> as the root element, got " + Tag(*root));
    Name(*root);
    for (const Element* e = root->FirstChildElement(); e; e = e->NextSiblingElement())
      if (e->ValueStr().starts_with("xacro:"))
        Fail(*e, "expected plain URDF, got the macro " + Tag(*e) + "; run xacro on the file first");
    ForEach(*root, "material", [this](const Element& e) { CheckMaterial(e, false); });
    ForEach(*root, "link", [this](const Element& e) { CheckLink(e); });
    if (links_.empty()) Fail(*root, "expected at least one <link>, got none");
    ForEach(*root, "joint", [this](const Element& e) { CheckJoint(e); });
    CheckTree(*root);
  }

 private:
  /// "<file>:<line>: <link or joint>, <element>: <what>".
  std::string Where(const Element& e) const {
    const Element* owner = &e;
    while (owner->Parent() && owner->Parent()->ToElement() &&
           owner->Parent()->ToElement()->ValueStr() != "robot")
      owner = owner->Parent()->ToElement();
    const char* name = owner->Attribute("name");
    std::string where = source_ + ":" + Text(e.Row()) + ": " + owner->ValueStr();
    if (name) where += ' ' + Quoted(name);
    return owner == &e ? where : where + ", " + Tag(e);
  }
  [[noreturn]] void Fail(const Element& e, const std::string& what) const {
    throw Error(Where(e) + ": " + what);
  }

  template <class F>
  static void ForEach(const Element& parent, const char* tag, F&& f) {
    for (const Element* e = parent.FirstChildElement(tag); e; e = e->NextSiblingElement(tag)) f(*e);
  }

  /// The one child of that name, or null.
  const Element* Child(const Element& parent, const char* tag) const {
    const Element* e = parent.FirstChildElement(tag);
    if (e)
      if (const Element* second = e->NextSiblingElement(tag))
        Fail(*second,
             "expected one " + Tag(*e) + ", got a second; the first is in line " + Text(e->Row()));
    return e;
  }
  const Element& NeededChild(const Element& parent, const char* tag,
                             const std::string& way_out = "") const {
    const Element* e = Child(parent, tag);
    if (!e) Fail(parent, "expected <" + std::string(tag) + ">, got none" + way_out);
    return *e;
  }

  std::string Attribute(const Element& e, const char* name) const {
    const char* value = e.Attribute(name);
    if (!value) Fail(e, "expected the attribute " + std::string(name) + ", got none");
    return value;
  }
  std::string Name(const Element& e) const {
    const std::string name = Attribute(e, "name");
    if (name.empty()) Fail(e, "expected a name, got \"\"");
    return name;
  }

  template <std::size_t n>
  std::array<double, n> Numbers(const Element& e, const char* name) const {
    const std::string text = Attribute(e, name);
    std::array<double, n> numbers{};
    std::size_t count = 0;
    bool good = true;
    std::istringstream words(text);
    for (std::string word; words >> word; ++count) {
      const std::optional<double> x = Number(word);
      good = good && x && count < n;
      if (good) numbers[count] = *x;
    }
    if (!good || count != n)
      Fail(e, std::string(name) + ": expected " +
                  (n == 1 ? "a finite number" : Text(n) + " finite numbers") + ", got " +
                  Quoted(text));
    return numbers;
  }
  double Positive(const Element& e, const char* name, const char* way_out = "") const {
    const double x = Numbers<1>(e, name)[0];
    if (!(x > 0)) Fail(e, std::string(name) + " must be > 0, got " + Text(x) + way_out);
    return x;
  }

  void CheckOrigin(const Element& parent) const {
    const Element* origin = Child(parent, "origin");
    if (!origin) return;
    for (const char* part : {"xyz", "rpy"})
      if (origin->Attribute(part)) Numbers<3>(*origin, part);
  }

  void CheckMaterial(const Element& e, bool may_refer) {
    const std::string name = Attribute(e, "name");
    const Element* color = Child(e, "color");
    if (color) {
      const auto rgba = Numbers<4>(*color, "rgba");
      if (std::ranges::any_of(rgba, [](double x) { return x < 0 || x > 1; }))
        Fail(*color, "rgba: expected numbers in [0, 1], got " + Quoted(Attribute(*color, "rgba")));
    }
    if (color || Child(e, "texture")) {
      materials_.insert(name);
    } else if (!may_refer) {
      Fail(e, "expected <color> or <texture>, got none");
    } else if (!materials_.contains(name)) {
      Fail(e, "there is no material " + Quoted(name) +
                  DidYouMean(name, {materials_.begin(), materials_.end()}));
    }
  }

  void CheckShape(const Element& e) {
    CheckOrigin(e);
    const Element& geometry = NeededChild(e, "geometry");
    const Element* shape = geometry.FirstChildElement();
    if (!shape) Fail(geometry, "expected <box>, <sphere>, <cylinder> or <mesh>, got none");
    const std::string kind = shape->ValueStr();
    if (kind == "box") {
      const auto size = Numbers<3>(*shape, "size");
      if (std::ranges::any_of(size, [](double x) { return x <= 0; }))
        Fail(*shape, "size: expected three numbers > 0, got " + Quoted(Attribute(*shape, "size")));
    } else if (kind == "sphere") {
      Positive(*shape, "radius");
    } else if (kind == "cylinder") {
      Positive(*shape, "radius");
      Positive(*shape, "length");
    } else if (kind == "mesh") {
      Attribute(*shape, "filename");
      if (shape->Attribute("scale")) Numbers<3>(*shape, "scale");
    } else {
      Fail(geometry, "expected <box>, <sphere>, <cylinder> or <mesh>, got " + Tag(*shape));
    }
    if (const Element* material = Child(e, "material")) CheckMaterial(*material, true);
  }

  void CheckLink(const Element& link) {
    const std::string name = Name(link);
    const auto [first, added] = links_.emplace(name, &link);
    if (!added)
      Fail(link, "expected a name of its own; the link in line " + Text(first->second->Row()) +
                     " has the same");
    if (const Element* inertial = Child(link, "inertial")) {
      CheckOrigin(*inertial);
      Inertial i;
      i.mass = Positive(NeededChild(*inertial, "mass"), "value",
                        "; leave out <inertial> where a link is only a frame");
      const Element& e = NeededChild(*inertial, "inertia");
      const auto at = [&](const char* part) { return Numbers<1>(e, part)[0]; };
      // All of them first: Eigen asserts if one that throws stands between its commas.
      const double xx = at("ixx"), yy = at("iyy"), zz = at("izz");
      const double xy = at("ixy"), xz = at("ixz"), yz = at("iyz");
      i.inertia << xx, xy, xz, xy, yy, yz, xz, yz, zz;
      CheckInertial(i, Where(e));
    }
    for (const char* tag : {"visual", "collision"})
      ForEach(link, tag, [this](const Element& e) { CheckShape(e); });
  }

  /// The link that <parent> or <child> of a joint names.
  std::string LinkOf(const Element& joint, const char* tag) const {
    const Element& e = NeededChild(joint, tag);
    const std::string name = Attribute(e, "link");
    if (links_.contains(name)) return name;
    std::vector<std::string> known;
    for (const auto& link : links_) known.push_back(link.first);
    Fail(e, "there is no link " + Quoted(name) + DidYouMean(name, known));
  }

  void CheckJoint(const Element& joint) {
    const std::string name = Name(joint);
    const auto [first, added] = joints_.emplace(name, &joint);
    if (!added)
      Fail(joint, "expected a name of its own; the joint in line " + Text(first->second->Row()) +
                      " has the same");
    const std::string type = Attribute(joint, "type");
    static const std::set<std::string> kMovable{"revolute", "continuous", "prismatic"};
    if (type != "fixed" && !kMovable.contains(type))
      Fail(joint, "expected type revolute, continuous, prismatic or fixed, got " + Quoted(type));
    CheckOrigin(joint);

    const std::string parent = LinkOf(joint, "parent"), child = LinkOf(joint, "child");
    if (const auto [other, only] = parent_joint_.emplace(child, &joint); !only)
      Fail(joint, "expected one parent for link " + Quoted(child) + ", got two: joint " +
                      Quoted(other->second->Attribute("name")) + " in line " +
                      Text(other->second->Row()) + " moves it too");
    parent_[child] = parent;

    if (const Element* mimic = Child(joint, "mimic"))
      Fail(*mimic,
           "expected independent joints, got one that mimics another; make it fixed, or leave "
           "out <mimic> and drive it by itself");
    if (const Element* dynamics = Child(joint, "dynamics"))
      for (const char* part : {"damping", "friction"})
        if (dynamics->Attribute(part) && !(Numbers<1>(*dynamics, part)[0] >= 0))
          Fail(*dynamics,
               std::string(part) + " must be >= 0, got " + Quoted(Attribute(*dynamics, part)));
    if (type == "fixed") return;

    const Element& axis =
        NeededChild(joint, "axis", "; write <axis xyz=\"1 0 0\"/> if the default of URDF is meant");
    const auto [x, y, z] = Numbers<3>(axis, "xyz");
    if (std::hypot(x, y, z) < 1e-6)
      Fail(axis, "xyz: expected a direction, got " + Quoted(Attribute(axis, "xyz")));
    CheckLimit(joint, type);
  }

  void CheckLimit(const Element& joint, const std::string& type) const {
    const Element* limit = Child(joint, "limit");
    if (!limit && type == "continuous") return;
    if (!limit)
      Fail(joint, "a " + type + " joint needs <limit lower upper velocity effort>, got none" +
                      (type == "revolute" ? "; a joint that turns without end is continuous" : ""));
    Positive(*limit, "velocity");
    Positive(*limit, "effort");
    if (type == "continuous") return;
    const double lower = Numbers<1>(*limit, "lower")[0], upper = Numbers<1>(*limit, "upper")[0];
    if (!(lower < upper))
      Fail(*limit, "lower must be < upper, got lower " + Text(lower) + " and upper " + Text(upper));
  }

  void CheckTree(const Element& robot) const {
    std::vector<std::string> roots;
    for (const auto& [name, link] : links_)
      if (!parent_.contains(name)) roots.push_back(name);
    std::ranges::sort(roots, {}, [this](const std::string& r) { return links_.at(r)->Row(); });
    if (roots.size() > 1) {
      std::string list;
      for (const std::string& r : roots)
        list +=
            (list.empty() ? "" : ", ") + Quoted(r) + " (line " + Text(links_.at(r)->Row()) + ")";
      Fail(robot, "expected one link without a parent, got " + Text(roots.size()) + ": " + list +
                      "; join them by a joint");
    }
    for (const auto& entry : links_) {
      std::vector<std::string> path{entry.first};
      for (auto up = parent_.find(path.back()); up != parent_.end();
           up = parent_.find(path.back())) {
        const auto seen = std::ranges::find(path, up->second);
        if (seen != path.end()) FailOnCycle({seen, path.end()});
        path.push_back(up->second);
      }
    }
  }

  /// `loop`: links from child to parent.
  [[noreturn]] void FailOnCycle(std::vector<std::string> loop) const {
    std::ranges::reverse(loop);
    std::ranges::rotate(loop, std::ranges::min_element(
                                  loop, {}, [this](const auto& l) { return links_.at(l)->Row(); }));
    std::string text;
    for (const std::string& link : loop) text += Quoted(link) + " -> ";
    Fail(*parent_joint_.at(loop.front()),
         "expected a tree, got a cycle of links: " + text + Quoted(loop.front()));
  }

  const std::string source_;
  TiXmlDocument document_;
  std::set<std::string> materials_;
  std::map<std::string, const Element*> links_, joints_;
  std::map<std::string, const Element*> parent_joint_;  // by child link
  std::map<std::string, std::string> parent_;           // link by child link
};

}  // namespace

void CheckUrdf(const std::string& text, const std::string& source) { Check(text, source).Run(); }

void CheckInertial(const Inertial& inertial, const std::string& what) {
  const Eigen::Matrix3d& I = inertial.inertia;
  Require(inertial.mass > 0 && std::isfinite(inertial.mass), what + ": mass must be > 0",
          inertial.mass);
  Require(inertial.center.allFinite() && I.allFinite(),
          what + ": expected finite numbers for centre of mass and inertia");
  const double rounding = 1e-12 * I.cwiseAbs().maxCoeff();
  Require((I - I.transpose()).cwiseAbs().maxCoeff() <= rounding,
          what + ": inertia must be symmetric");
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(I, Eigen::EigenvaluesOnly).eigenvalues();
  const std::string found = "principal moments " + Text(moments[0]) + ", " + Text(moments[1]) +
                            " and " + Text(moments[2]) + " kg·m²; check units and signs";
  Require(moments[0] >= -rounding,
          what + ": no body has this inertia: expected no moment < 0, got " + found);
  Require(moments[0] + moments[1] >= moments[2] - 3 * rounding,
          what + ": no body has this inertia: expected none above the sum of the two others, got " +
              found);
}

std::string DidYouMean(std::string_view name, const std::vector<std::string>& known) {
  const auto distance = [name](const std::string& other) {  // Levenshtein
    std::vector<std::size_t> row(other.size() + 1);
    for (std::size_t k = 0; k <= other.size(); ++k) row[k] = k;
    for (std::size_t i = 1; i <= name.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i;
      for (std::size_t k = 1; k <= other.size(); ++k) {
        const std::size_t replace = diagonal + (name[i - 1] == other[k - 1] ? 0 : 1);
        diagonal = row[k];
        row[k] = std::min({row[k] + 1, row[k - 1] + 1, replace});
      }
    }
    return row.back();
  };
  const auto nearest = std::ranges::min_element(known, {}, distance);
  if (nearest == known.end() || distance(*nearest) > std::max<std::size_t>(2, name.size() / 2))
    return "";
  return "; did you mean " + Quoted(*nearest) + "?";
}

}  // namespace pliant::internal
