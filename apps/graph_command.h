#pragma once

#include <vector>

#include "pliant/apps/commands.h"

namespace pliant {

void AddGraph(CLI::App& app, std::vector<Command>& commands);  ///< graph

}  // namespace pliant
