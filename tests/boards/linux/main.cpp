#include "board.hpp"

int main() { return board::program(); }
