"""Films of agents who look for something: read, acted out, judged, and compared with people.

The form of a file is that of the food trucks (Baker, Jara-Ettinger, Saxe and Tenenbaum 2017).
"""
