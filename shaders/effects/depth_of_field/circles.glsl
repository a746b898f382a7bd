// Classes of circles of confusion: by width, on either side of the focus.

uniform float least_coc_px;             // narrower ones are none
uniform float first_class_px;           // classes double from here
uniform int class_count;                // on each side of the focus

bool is_sharp(float coc_px) { return abs(coc_px) < least_coc_px; }

// 0: sharp; ±1: narrower than first_class_px; ±2: up to twice that; ±3: up to four times …
int class_of(float coc_px) {
    float width = abs(coc_px);
    if (width < least_coc_px) return 0;
    int size = width < first_class_px ? 1 : min(2 + int(floor(log2(width / first_class_px))), class_count);
    return coc_px < 0.0 ? -size : size;
}

// Sets of classes as bits.
uint bit_of(int which) { return 1u << (which + class_count); }
