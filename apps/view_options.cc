#include "pliant/apps/view_options.h"

#include <CLI/CLI.hpp>
#include <cstdio>

#include "pliant/apps/commands.h"
#include "pliant/apps/says_something.h"

namespace pliant {

namespace {

bool IsLoopback(const std::string& address) {
  return address.starts_with("127.") || address == "::1";
}

}  // namespace

void AddViewOptions(CLI::App& app, ViewTold& told) {
  CLI::Option* view =
      app.add_flag("--view", told.view, "show the run in a browser, at the pace of the wall clock");
  app.add_option("--port", told.port, "of the page; 0: any that is free")
      ->needs(view)
      ->capture_default_str();
  app.add_option("--listen", told.listen,
                 "address of this machine at which the page is served; any but a loopback shows it "
                 "to the network")
      ->needs(view)
      ->check(SaysSomething())
      ->capture_default_str();
  app.add_option("--origin", told.origins, "such as https://example.org, of pages that may ask too")
      ->needs(view)
      ->allow_extra_args(false);
  app.add_flag("--control", told.control,
               "who sees the page may also change parameters; granted to a simulation that only "
               "this machine sees")
      ->needs(view);
}

std::unique_ptr<LiveView> ViewOf(const ViewTold& told, bool is_about_an_arm) {
  if (!told.view) return {};
  const bool alone = IsLoopback(told.listen);
  try {
    auto view = std::make_unique<LiveView>(
        LiveView::Options{.address = told.listen,
                          .port = told.port,
                          .control = told.control || (alone && !is_about_an_arm),
                          .origins = told.origins});
    std::fprintf(stderr, "%s shows the run; Ctrl-C ends it\n", view->url().c_str());
    if (!alone)
      std::fprintf(stderr, "everybody who reaches %s may look, and may stop it\n",
                   told.listen.c_str());
    return view;
  } catch (const Error& e) {
    throw CannotGoOn(e.what());
  }
}

}  // namespace pliant
