// How fast this machine moves texels: the bound that no pass can beat.
#pragma once

namespace matchlight {

/// Bytes read and written a second by copying a large RGBA16F texture: the best of several, measured when first asked.
double copy_bytes_per_second();

}  // namespace matchlight
