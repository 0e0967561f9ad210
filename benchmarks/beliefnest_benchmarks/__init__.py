"""`beliefnest bench`: measurements, each printed beside the figure it is to reach.

A bench is a module with a function `measure() -> Sequence[Figure]`; it is registered in
`registry.BENCHES`.
"""
