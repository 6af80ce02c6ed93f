#pragma once

#include <algorithm>
#include <array>
#include <string>

#include "pliant/plants/robot_model.h"
#include "pliant/systems/signal.h"

namespace pliant {

/// Largest number of contacts that are told apart.
inline constexpr int kMaxContacts = 3;

/// Where arms are touched, and by what: a contact keeps its place as long as it lasts, and a place
/// whose link is −1 is free. Forces are of the environment on the arm, in world axes; where nothing
/// is known of them they are zero.
struct Contacts {
  using Space = Nothing;
  static constexpr Quantity quantity{"contacts", ""};

  std::array<ContactForce, kMaxContacts> at;

  int count() const {
    return static_cast<int>(
        std::ranges::count_if(at, [](const ContactForce& contact) { return contact.link >= 0; }));
  }

  template <class Visitor>
  void Fields(Visitor&& f) {
    for (std::size_t i = 0; i < at.size(); ++i) f("contact_" + std::to_string(i + 1), at[i], "");
  }
};

/// Whether a link is one of the model's: −1, none, is not, nor what a wire may bring from
/// elsewhere.
inline bool IsLink(const RobotModel& model, int link) {
  return link >= 0 && link < static_cast<int>(model.links().size());
}

}  // namespace pliant
