// Radii: Bondi 1964, "van der Waals Volumes and Radii"; what he leaves out, Alvarez 2013, "A cartography of the van der
// Waals territories"; 2 Å where neither has one. Colours: Jmol's.
#include "scene/element_table.h"

#include <cassert>
#include <cstddef>

#include "scene/text_fields.h"

namespace matchlight {
namespace {

constexpr int element_count = 118;

// clang-format off
constexpr std::array<Element, element_count + 1> elements = {{
    {"X", 2.00F, 0xff1493},
    {"H", 1.20F, 0xffffff}, {"He", 1.40F, 0xd9ffff}, {"Li", 1.82F, 0xcc80ff}, {"Be", 1.98F, 0xc2ff00},
    {"B", 1.91F, 0xffb5b5}, {"C", 1.70F, 0x909090}, {"N", 1.55F, 0x3050f8}, {"O", 1.52F, 0xff0d0d},
    {"F", 1.47F, 0x90e050}, {"Ne", 1.54F, 0xb3e3f5}, {"Na", 2.27F, 0xab5cf2}, {"Mg", 1.73F, 0x8aff00},
    {"Al", 2.25F, 0xbfa6a6}, {"Si", 2.10F, 0xf0c8a0}, {"P", 1.80F, 0xff8000}, {"S", 1.80F, 0xffff30},
    {"Cl", 1.75F, 0x1ff01f}, {"Ar", 1.88F, 0x80d1e3}, {"K", 2.75F, 0x8f40d4}, {"Ca", 2.62F, 0x3dff00},
    {"Sc", 2.58F, 0xe6e6e6}, {"Ti", 2.46F, 0xbfc2c7}, {"V", 2.42F, 0xa6a6ab}, {"Cr", 2.45F, 0x8a99c7},
    {"Mn", 2.45F, 0x9c7ac7}, {"Fe", 2.44F, 0xe06633}, {"Co", 2.40F, 0xf090a0}, {"Ni", 1.63F, 0x50d050},
    {"Cu", 1.40F, 0xc88033}, {"Zn", 1.39F, 0x7d80b0}, {"Ga", 1.87F, 0xc28f8f}, {"Ge", 2.29F, 0x668f8f},
    {"As", 1.85F, 0xbd80e3}, {"Se", 1.90F, 0xffa100}, {"Br", 1.85F, 0xa62929}, {"Kr", 2.02F, 0x5cb8d1},
    {"Rb", 3.21F, 0x702eb0}, {"Sr", 2.84F, 0x00ff00}, {"Y", 2.75F, 0x94ffff}, {"Zr", 2.52F, 0x94e0e0},
    {"Nb", 2.56F, 0x73c2c9}, {"Mo", 2.45F, 0x54b5b5}, {"Tc", 2.44F, 0x3b9e9e}, {"Ru", 2.46F, 0x248f8f},
    {"Rh", 2.44F, 0x0a7d8c}, {"Pd", 1.63F, 0x006985}, {"Ag", 1.72F, 0xc0c0c0}, {"Cd", 1.58F, 0xffd98f},
    {"In", 1.93F, 0xa67573}, {"Sn", 2.17F, 0x668080}, {"Sb", 2.47F, 0x9e63b5}, {"Te", 2.06F, 0xd47a00},
    {"I", 1.98F, 0x940094}, {"Xe", 2.16F, 0x429eb0}, {"Cs", 3.48F, 0x57178f}, {"Ba", 3.03F, 0x00c900},
    {"La", 2.98F, 0x70d4ff}, {"Ce", 2.88F, 0xffffc7}, {"Pr", 2.92F, 0xd9ffc7}, {"Nd", 2.95F, 0xc7ffc7},
    {"Pm", 2.00F, 0xa3ffc7}, {"Sm", 2.90F, 0x8fffc7}, {"Eu", 2.87F, 0x61ffc7}, {"Gd", 2.83F, 0x45ffc7},
    {"Tb", 2.79F, 0x30ffc7}, {"Dy", 2.87F, 0x1fffc7}, {"Ho", 2.81F, 0x00ff9c}, {"Er", 2.83F, 0x00e675},
    {"Tm", 2.79F, 0x00d452}, {"Yb", 2.80F, 0x00bf38}, {"Lu", 2.74F, 0x00ab24}, {"Hf", 2.63F, 0x4dc2ff},
    {"Ta", 2.53F, 0x4da6ff}, {"W", 2.57F, 0x2194d6}, {"Re", 2.49F, 0x267dab}, {"Os", 2.48F, 0x266696},
    {"Ir", 2.41F, 0x175487}, {"Pt", 1.75F, 0xd0d0e0}, {"Au", 1.66F, 0xffd123}, {"Hg", 1.55F, 0xb8b8d0},
    {"Tl", 1.96F, 0xa6544d}, {"Pb", 2.02F, 0x575961}, {"Bi", 2.54F, 0x9e4fb5}, {"Po", 2.00F, 0xab5c00},
    {"At", 2.00F, 0x754f45}, {"Rn", 2.00F, 0x428296}, {"Fr", 2.00F, 0x420066}, {"Ra", 2.00F, 0x007d00},
    {"Ac", 2.80F, 0x70abfa}, {"Th", 2.93F, 0x00baff}, {"Pa", 2.88F, 0x00a1ff}, {"U", 1.86F, 0x008fff},
    {"Np", 2.82F, 0x0080ff}, {"Pu", 2.81F, 0x006bff}, {"Am", 2.83F, 0x545cf2}, {"Cm", 3.05F, 0x785ce3},
    {"Bk", 3.40F, 0x8a4fe3}, {"Cf", 3.05F, 0xa136d4}, {"Es", 2.70F, 0xb31fd4}, {"Fm", 2.00F, 0xb31fba},
    {"Md", 2.00F, 0xb30da6}, {"No", 2.00F, 0xbd0d87}, {"Lr", 2.00F, 0xc70066}, {"Rf", 2.00F, 0xcc0059},
    {"Db", 2.00F, 0xd1004f}, {"Sg", 2.00F, 0xd90045}, {"Bh", 2.00F, 0xe00038}, {"Hs", 2.00F, 0xe6002e},
    {"Mt", 2.00F, 0xeb0026}, {"Ds", 2.00F, 0xeb0026}, {"Rg", 2.00F, 0xeb0026}, {"Cn", 2.00F, 0xeb0026},
    {"Nh", 2.00F, 0xeb0026}, {"Fl", 2.00F, 0xeb0026}, {"Mc", 2.00F, 0xeb0026}, {"Lv", 2.00F, 0xeb0026},
    {"Ts", 2.00F, 0xeb0026}, {"Og", 2.00F, 0xeb0026},
}};
// clang-format on

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}
bool is_letter(char c) {
    return lower(c) >= 'a' && lower(c) <= 'z';
}

/// Of a symbol of one or two letters; 0 where there is no such.
int number_of(std::string_view symbol) {
    // By first and second letter ('`' stands before 'a': none).
    static const auto by_letters = [] {
        std::array<std::uint8_t, 27 * 27> table{};
        for (int number = 1; number <= element_count; ++number) {
            const std::string_view one = elements[static_cast<std::size_t>(number)].symbol;
            const int second = one.size() > 1 ? lower(one[1]) - '`' : 0;
            table[static_cast<std::size_t>((lower(one[0]) - '`') * 27 + second)] = static_cast<std::uint8_t>(number);
        }
        table[static_cast<std::size_t>(('d' - '`') * 27)] = 1;  // deuterium
        return table;
    }();
    const int second = symbol.size() > 1 ? lower(symbol[1]) - '`' : 0;
    return by_letters[static_cast<std::size_t>((lower(symbol[0]) - '`') * 27 + second)];
}

}  // namespace

const Element& element(int atomic_number) {
    assert(atomic_number >= 0 && atomic_number <= element_count);
    return elements[static_cast<std::size_t>(atomic_number)];
}

int atomic_number(std::string_view symbol) {
    symbol = trimmed(symbol);
    if (const auto number = count_in(symbol)) return *number <= element_count ? static_cast<int>(*number) : 0;
    std::size_t letters = 0;
    while (letters < symbol.size() && is_letter(symbol[letters])) ++letters;
    return letters == 1 || letters == 2 ? number_of(symbol.substr(0, letters)) : 0;
}

}  // namespace matchlight
