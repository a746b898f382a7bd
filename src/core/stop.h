// A request to stop (SIGINT, SIGTERM): the frame in hand is finished, then the command ends with status 1.
#pragma once

namespace matchlight {

/// Makes SIGINT and SIGTERM set the flag; a second signal ends the process at once.
void install_stop_handlers();

/// Whether there was one, or what this thread works on is given up (core/work.h).
bool stop_requested();

}  // namespace matchlight
