#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "pliant/analysis/live_view.h"

namespace CLI {
class App;
}

namespace pliant {

/// What `pliant run --view` is told besides.
struct ViewTold {
  bool view = false;
  std::uint16_t port = 8765;
  std::string listen = "127.0.0.1";
  std::vector<std::string> origins;
  bool control = false;
};

void AddViewOptions(CLI::App& app, ViewTold& told);

/// The view that is asked for, which listens, and says where; null if none is. A simulation that
/// only this machine sees may be controlled by who sees it; all else needs --control.
std::unique_ptr<LiveView> ViewOf(const ViewTold& told, bool is_about_an_arm);

}  // namespace pliant
