// A page and its simulation for browsers on this machine: HTTP and WebSocket on the loopback interface, below a random word that
// only who was given the address knows; pages of other origins are refused.
#pragma once

#include <functional>
#include <string>

#include "simulation.hpp"

namespace cli::live {

// Serves until SIGINT or SIGTERM. port 0: one that is free. ready is called with the address once it is there.
void serve(Simulation& simulation, const std::string& page, unsigned short port,
           const std::function<void(const std::string& address)>& ready);

}  // namespace cli::live
