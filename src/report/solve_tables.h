// The tables of a solve's page.
#pragma once

#include <string>
#include <vector>

#include "report/solve_findings.h"

namespace matchlight {

std::string summary_table(const Solve& solve, const SolveFindings& found);
/// Residuals by tag.
std::string tag_table(const std::vector<TagFindings>& tags);
/// What holds for the whole clip: lens with its uncertainty, shutter, response, vignette, noise.
std::string clip_table(const Solve& solve);

}  // namespace matchlight
