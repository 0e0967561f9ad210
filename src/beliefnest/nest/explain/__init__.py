"""Why a simulator holds what it holds, and where two of them differ."""
