// Measures again what the source paper measured.
#include <iostream>
#include <string>
#include <vector>

#include "paper_command.h"

int main(int count, char** words) {
  return organ_collision::tools::reproducePaper(std::vector<std::string>(words + 1, words + count),
                                                std::cout, std::cerr);
}
