// A loop spread over the cores; the work of one index must not depend on another's, so results never depend on threads.
#pragma once

#include <functional>

namespace matchlight {

/// Calls `body(i)` for i in [0, count), in any order, on up to as many threads as there are cores. An exception from
/// any call is rethrown in the caller once all threads have ended.
void parallel_for(int count, const std::function<void(int)>& body);

}  // namespace matchlight
