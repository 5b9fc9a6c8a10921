"""What tests of planners share is imported from this folder, from those below it too."""
