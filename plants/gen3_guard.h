#pragma once

#include <chrono>

#include "pliant/plants/gen3_address.h"
#include "pliant/plants/socket.h"

namespace pliant {

/// Hands an arm back if this process dies, in whatever way, kill −9 included: else the arm stays in
/// low-level servoing until its session's time is over.
///
/// A child process that waits for a word. The destructor gives it: destroy the guard once the arm
/// was handed back. If the word does not come because the process is gone, the child connects anew,
/// sets all actuators to position mode and the arm to single-level servoing, tries again for
/// `patience`, which is longer than a session lives, and says in a line on the standard error how
/// that went.
///
/// The child has no descriptor of this process but the standard error, is in a session of its own
/// where no terminal's signal reaches it, and runs without real-time priority. Two things end it
/// with this process: a signal to it by its number, and a kill of the whole control group.
///
/// Make it early. The child is a fork: what another thread had locked then stays locked in it, and
/// the first write to each page costs this process a fault, unless its memory is locked afterwards.
/// The host's name is looked up before.
class Gen3Guard {
 public:
  /// Throws Error if the host is not known, or there cannot be another process.
  explicit Gen3Guard(const Gen3Address& address,
                     std::chrono::milliseconds patience = std::chrono::seconds(70));
  ~Gen3Guard();
  Gen3Guard(const Gen3Guard&) = delete;
  Gen3Guard& operator=(const Gen3Guard&) = delete;

  /// That the arm could not be handed back: at its end the guard tries what it would try for a
  /// process that is gone, and takes as long.
  void NotHandedBack() { handed_back_ = false; }

  /// The child, for who looks at the list of processes.
  int process() const { return child_; }

 private:
  Socket word_;
  bool handed_back_ = true;
  int child_;
};

}  // namespace pliant
