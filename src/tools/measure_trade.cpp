// Measures what accuracy costs on the user's own mesh.
#include <iostream>
#include <string>
#include <vector>

#include "trade_command.h"

int main(int count, char** words) {
  return organ_collision::tools::measureTrade(std::vector<std::string>(words + 1, words + count),
                                              std::cout, std::cerr);
}
