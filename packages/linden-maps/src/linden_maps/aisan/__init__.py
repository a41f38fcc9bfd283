"""The Aisan vector map of Autoware.AI: a folder of CSV files."""
