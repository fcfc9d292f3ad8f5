"""The control tick: tasks over contacts, ordered in a stack, become rows; the solver's answer becomes torques."""
