"""Classes that users of a nest work with: nests and simulators, live and recorded."""
