// The page that shows a light probe: what it looks like, what it lights, where its lamps are and what it does not know.
#pragma once

#include <string>
#include <vector>

#include "lighting/dominant_lights.h"
#include "lighting/probe.h"
#include "lighting/probe_record.h"

namespace matchlight {

struct ProbePageInput {
    std::string name;         // of the file
    std::string description;  // size, mapping, how it was recognised
    const Probe& probe;
    const ProbeRecord& record;
    ProbeStatistics statistics;
    ProbeCoverage coverage;
    std::vector<DominantLight> lights;
    std::vector<DirectionalSample> median_cut;
    std::int64_t repaired_samples = 0;
};

/// One HTML page that needs nothing else.
std::string probe_page(const ProbePageInput& input);

}  // namespace matchlight
