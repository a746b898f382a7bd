// How much memory a job may still ask for.
#pragma once

#include <cstdint>

namespace matchlight {

/// What the system can hand out without swapping (MemAvailable of /proc/meminfo); half of the installed memory where
/// that is not said.
std::uint64_t available_memory_bytes();

}  // namespace matchlight
