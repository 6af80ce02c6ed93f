// use of deleted function
#include "pliant/systems/simulator.h"

void Run(pliant::DiagramBuilder& b) { pliant::Simulator sim{b.Build()}; }
