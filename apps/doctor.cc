#include "pliant/apps/commands.h"

namespace pliant {
void AddDoctor(CLI::App&, std::vector<Command>&) {}
}  // namespace pliant
