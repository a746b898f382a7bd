// EXR through OpenEXR itself: the parts of a file and their channels, with every limit checked before memory is given.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <OpenEXR/ImfForward.h>

#include "core/image.h"

namespace matchlight {

/// Lets OpenEXR compress and decompress on all cores; results do not depend on how many.
void use_exr_threads();

/// An EXR file whose headers are sane: windows within the limits, channel counts too, at least one part.
class ExrFile {
public:
    /// Throws InputError.
    explicit ExrFile(const std::filesystem::path& path);
    ~ExrFile();

    int parts() const;
    const Imf::Header& header(int part) const;
    std::string part_name(int part) const;  // empty in single-part files
    bool has_channel(int part, const std::string& channel) const;
    /// The channels of a flat (not deep) part over its display window, 0 outside the data window. Throws InputError.
    ImageF read(int part, const std::vector<std::string>& channels) const;

private:
    std::filesystem::path path_;
    std::unique_ptr<Imf::MultiPartInputFile> file_;
};

}  // namespace matchlight
