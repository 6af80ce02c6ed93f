#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "pliant/apps/says_something.h"
#include "pliant/plants/gen3_address.h"
#include "pliant/systems/error.h"

namespace pliant {

/// The options of a command that name an arm and who comes.
struct ArmOptions {
  std::string arm, user = "admin", password = "admin";

  /// Throws Error that names the option.
  Gen3Address address() const {
    try {
      Gen3Address address = arm.empty() ? Gen3Address{} : Gen3Address::Of(arm);
      address.user = user;
      address.password = password;
      return address;
    } catch (const Error& e) {
      throw Error(std::string("--arm: ") + e.what());
    }
  }

  void AddTo(CLI::App& command, const std::string& about_arm) {
    command.add_option("--arm", arm, about_arm)->check(SaysSomething());
    command.add_option("--user", user, "who opens a session with the arm")
        ->check(SaysSomething())
        ->capture_default_str();
    command
        .add_option("--password", password,
                    "of that user; as an arm leaves the factory unless told")
        ->check(SaysSomething());
  }
};

}  // namespace pliant
