// The part of the teaching report that tells what a pose must show to be believed. Internal to teach.
#pragma once

#include <string>

#include "contract/part_template.hpp"

namespace beltpick::teach {

std::string requirement_table(const PartTemplate& part);

}  // namespace beltpick::teach
