"""Page that plays back a nest over time: its data, and the HTML around it."""
