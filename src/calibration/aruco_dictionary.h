// The dictionaries of ArUco markers that OpenCV knows by name.
#pragma once

#include <span>

#include "calibration/board.h"

namespace matchlight {

struct ArucoDictionary {
    const char* name;
    int id;       // OpenCV's number of it
    int markers;  // how many it has
};

std::span<const ArucoDictionary> aruco_dictionaries();

/// Of a ChArUco board. "DICT_5X5" alone means the smallest of them that has enough markers: the smaller ones begin the
/// larger. Throws InputError for a name that OpenCV does not know and for a dictionary that is too small.
const ArucoDictionary& aruco_dictionary_of(const BoardSpec& board);

}  // namespace matchlight
