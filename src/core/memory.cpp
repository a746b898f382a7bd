// Reads /proc/meminfo.
#include "core/memory.h"

#include <fstream>
#include <string>

#include <unistd.h>

namespace matchlight {

std::uint64_t available_memory_bytes() {
    std::ifstream file("/proc/meminfo");
    file.imbue(std::locale::classic());
    std::string key;
    while (file >> key) {
        std::uint64_t kibibytes = 0;
        std::string rest;
        if (key == "MemAvailable:" && file >> kibibytes) return kibibytes * 1024;
        std::getline(file, rest);
    }
    return static_cast<std::uint64_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) / 2;
}

}  // namespace matchlight
