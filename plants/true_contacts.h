#pragma once

#include <array>

#include "pliant/plants/contacts.h"
#include "pliant/systems/block.h"

namespace pliant {

/// Where the environment touches an arm, each contact in a place of its own, every h.
///
/// A force that joins takes the lowest free place at the tick at which it is no longer zero, and
/// keeps it until it is zero again; so a contact does not change its place when another one ends.
/// Those for which no place is free wait for one and are counted.
///
/// This is what a simulation knows and an arm does not. What is said of the forces themselves is
/// for comparison: who controls the arm reads the links and the points.
class TrueContacts final : public Block {
 public:
  struct Options {
    Duration period;  ///< h
  };

  /// What it remembers from one tick to the next.
  struct Memory {
    Contacts contacts;
    std::array<int, kMaxContacts> source{-1, -1, -1};  ///< which of the forces, −1: none
    int left_out = 0;

    template <class Visitor>
    void Fields(Visitor&& f) {
      f("contacts", contacts, "");
      f("source", source, "");
      f("left_out", left_out, "");
    }
  };

  explicit TrueContacts(const Options& o);

  InputList<ContactForce> forces;
  Output<Contacts> contacts;
  Output<int> left_out;  ///< contacts without a place

 private:
  Memory Next(const Memory& last, const Joined<ContactForce>& forces) const;

  Output<Memory> memory_;
};

}  // namespace pliant
