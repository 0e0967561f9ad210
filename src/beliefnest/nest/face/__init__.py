"""What users of a nest hold in their hands."""
