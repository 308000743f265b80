// Composite joints for a page: what it needs to move them.
#pragma once

#include "../cli.hpp"

namespace cli::page {

// A joint as a product of exponentials (Brockett 1984), X = X_rest exp(B_1 x_1) .. exp(B_nv x_nv) from its parent joint to it,
// the twists B [linear; angular] in its own frame at rest: {"rest": 12 numbers, "parts": [{"kind", "twists"}]}. kind is how q
// holds x: "screw": as it is; "circle": its cosine and sine; "ball": three rotations as one quaternion.
json chain_json(const Robot& robot, const dynJointInfo& joint);

}  // namespace cli::page
