#include "pliant/plants/true_contacts.h"

#include <algorithm>

namespace pliant {

namespace {

bool Touches(const ContactForce& contact) {
  return contact.link >= 0 && (!contact.force.isZero(0) || !contact.moment.isZero(0));
}

}  // namespace

TrueContacts::TrueContacts(const Options& o)
    : forces{this, "forces"},
      contacts{this, "contacts"},
      left_out{this, "left_out"},
      memory_{this, "memory"} {
  Every(o.period).Compute(memory_).From(memory_, forces).As(&TrueContacts::Next);
  Compute(contacts).From(memory_).As([](const Memory& m) { return m.contacts; });
  Compute(left_out).From(memory_).As([](const Memory& m) { return m.left_out; });
}

TrueContacts::Memory TrueContacts::Next(const Memory& last,
                                        const Joined<ContactForce>& joined) const {
  Memory now = last;
  for (int& source : now.source)
    if (source >= joined.size() || (source >= 0 && !Touches(joined[source]))) source = -1;
  now.left_out = 0;
  for (int i = 0; i < joined.size(); ++i) {
    if (!Touches(joined[i]) || std::ranges::count(now.source, i) > 0) continue;
    const auto free = std::ranges::find(now.source, -1);
    if (free == now.source.end())
      ++now.left_out;
    else
      *free = i;
  }
  for (std::size_t place = 0; place < now.source.size(); ++place)
    now.contacts.at[place] = now.source[place] < 0 ? ContactForce{} : joined[now.source[place]];
  return now;
}

}  // namespace pliant
