// The model dump and the states, read or drawn.
#pragma once

#include "pinocchio_bench.hpp"

// Kinds of configuration coordinates, to draw valid random configurations.
enum class Kind { Vector, Circle, Quaternion, Planar, Free };

struct JointKind
{
  Kind kind;
  int q;
};

// A foot on the ground.
struct Contact
{
  pinocchio::JointIndex joint;
  pinocchio::SE3 placement;
  bool point;
};

struct Loaded
{
  std::string name;
  Model model;
  std::vector<JointKind> kinds;
  std::vector<Contact> contacts;
};

void addConstraintRows(Bench &, const std::vector<Contact> &);

Loaded loadModel(const std::string & path);

std::vector<State> makeStates(const Loaded & m);
std::vector<State> readStates(const std::string & path, const Loaded & m);
void writeStates(const std::string & path, const std::vector<State> & states);
